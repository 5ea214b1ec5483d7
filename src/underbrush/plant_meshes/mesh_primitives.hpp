/// \file
/// Primitives made of plant meshes, for the comparison simulator of [tallavajhula18] §V.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "underbrush/primitives/extract.hpp"
#include "underbrush/primitives/size_rules.hpp"

namespace underbrush {
/// Primitives made of plant meshes.
namespace plant_meshes {

/// A plant as triangles (m, z up), anywhere in space.
struct PlantSource {
  std::string name;
  std::vector<Vec3f> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
  /// Class that the plant stands for at its own size. Without one it is scaled into the classes.
  std::optional<elements::Class> label = {};
};

/// Options of `mesh_primitives`.
struct MeshPrimitiveOptions {
  primitives::SizeRules sizes;
  int sizes_per_class = 3;        ///< Number of heights to which a plant is scaled within a class.
  double most_scaling = 2;        ///< A plant is scaled by at most this factor, up or down.
  double tallest_tree_m = 16;     ///< m; height at which the tallest class ends.
  double lowest_shrub_m = 0.15;   ///< m; height at which the lowest class begins.
  double cell_m = 2;              ///< m; side of the cells of patches.
  int cells_per_size = 2;         ///< Number of patch cells of each height.
  size_t most_triangles = 60000;  ///< A patch cell with this many triangles gets no further plant.
  double range_sigma_m = 0.02;    ///< m; standard deviation of the Gaussian noise on ranges.
  uint64_t seed = 1;
};

/// Scales plants and sorts them into the classes. Plants of at least `sizes.tree_m` are trees,
/// others shrubs. Each is placed in every class of its kind, at heights spread evenly over the
/// class, as far as `most_scaling` allows; a class that is left empty takes the plant that needs
/// the least scaling. A patch cell holds shrubs of its height, turned and placed at random, until
/// their discs would cover it. Pose and box are as in `extract`: foot under the centroid, x along
/// the longer principal axis of the vertices, bottom of the box on the ground. Triangles are
/// opaque. Throws `std::invalid_argument` for a plant without triangles or without height.
std::vector<primitives::Primitive> mesh_primitives(const std::vector<PlantSource>& plants,
                                                   const MeshPrimitiveOptions& options = {});

}  // namespace plant_meshes
}  // namespace underbrush
