/// \file
/// Models and scenes cut into regions.
#pragma once
#include <filesystem>

#include "underbrush/elements/scene_file.hpp"

namespace underbrush::regions {

/// The most elements and instances of a region, on average, where the side is chosen by them.
inline constexpr size_t kMostOfRegion = 100'000;

/// Returns the largest side (m), a power of two from 16 to 1024 m, with which the regions of a
/// scene have at most `kMostOfRegion` elements and instances on average; 16 m if none has so few.
double side_by_elements(const elements::Scene& scene);

/// Writes a scene, or a model as a scene without instances, as a world of regions of the side
/// `side_m` (m). An element lies in the region of its middle, and an instance in that of its
/// origin. Of a scene, the model of the first instance is cut; moving instances belong to no
/// region. `provenance` is a JSON object. Returns the number of regions. Throws `IoError`, and
/// `std::invalid_argument` for a side that is not positive, and for a scene whose first instance is
/// turned or scaled, moves, stands twice, or has a map of observed space.
size_t write_world(const std::filesystem::path& path, const elements::Scene& scene,
                   const elements::SceneInfo& info, double side_m, const std::string& provenance);

}  // namespace underbrush::regions
