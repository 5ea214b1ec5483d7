/// \file
/// The writer of worlds of regions.
#pragma once
#include <filesystem>
#include <span>
#include <vector>

#include "underbrush/elements/scene_file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/regions/index.hpp"

namespace underbrush::regions {

/// The content of a region, with its numbers in the whole, which ascend.
struct RegionContent {
  /// Elements of the model that is cut, relative to its origin, with its parameters and without
  /// keyframes.
  elements::Model model;
  std::array<std::vector<uint32_t>, 3> numbers;  ///< Number of each element, by `elements::Kind`.
  std::vector<elements::Instance> instances;
  std::vector<elements::Class> labels;     ///< The class of each instance.
  std::vector<uint32_t> instance_numbers;  ///< The number of each instance.
};

/// Writes a world region by region, so that no more than one needs to be in memory. The folder
/// appears whole with `finish`, or not at all.
class WorldWriter {
 public:
  /// `path` is the folder, which replaces a world that stands there, and `side_m` the side of the
  /// regions. Throws `IoError`, also if a folder that is not a world stands there, and
  /// `std::invalid_argument` for a side that is not positive.
  WorldWriter(const std::filesystem::path& path, double side_m);

  /// Adds a region, each square once, in any order. `boxes` has the box of what rays can meet of
  /// each model of the scene, in the model's frame (m). Throws `IoError`.
  void add(const Cell2& square, RegionContent content, std::span<const Eigen::AlignedBox3d> boxes);
  /// Writes the common part of all regions of a model: its parameters, its keyframes and the map of
  /// observed space. `whole` has the parameters; its elements count where space is unknown
  /// (`elements::PartOf::ground`) and for the mean reflectance. Throws `IoError`.
  void finish(const elements::Model& whole, const std::string& provenance);
  /// Writes that of a scene: `common` has all models, of which the first is the one that is cut and
  /// stands as its first instance, and the instances that belong to no region, with their numbers.
  void finish(const elements::Scene& common, const elements::SceneInfo& info);

 private:
  void commit();

  io::AtomicFile folder_;
  Index index_;
};

/// Throws the `IoError` that a `WorldWriter` would begin with.
void check_world_output(const std::filesystem::path& path);

}  // namespace underbrush::regions
