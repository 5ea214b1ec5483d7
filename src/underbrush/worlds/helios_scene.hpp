/// \file
/// Scenes of HELIOS++ (XML).
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "underbrush/worlds/mesh_world.hpp"

namespace underbrush::worlds {

/// The place of a part of a scene: x_world = translation + scale · R x_file. HELIOS++ keeps the
/// last scale and the last offset of a chain of filters and multiplies its rotations, and so does
/// this.
struct PartPlace {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  double scale = 1;
  Vec3 translation = Vec3::Zero();
};

/// Whether the path is an XML file, which is taken for one of HELIOS++.
bool is_helios(const std::filesystem::path& path);

/// Reads the scene `id` (the first one if empty) of an XML file: its parts with the filters
/// objloader, detailedvoxels, translate, rotate and scale. Files are looked for beside the XML file
/// and in the folder `assets`. A file that several parts name is stored once. Instances count from
/// 1 in the order of the parts; a part has one for each of its materials. A survey is read for its
/// scene. Throws `FormatError`.
World read_helios_scene(const std::filesystem::path& path, const std::string& id = "",
                        const std::filesystem::path& assets = {});

/// Returns the height (m) of the highest triangle of class ground above or below a place; nothing
/// where there is none.
std::optional<double> ground_at(const World& world, double x, double y);

}  // namespace underbrush::worlds
