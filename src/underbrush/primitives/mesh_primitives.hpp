/// \file
/// Primitives made of plant meshes: the comparison simulator of [tallavajhula18] §V.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "underbrush/primitives/extract.hpp"
#include "underbrush/primitives/size_rules.hpp"

namespace underbrush::primitives {

/// A plant as triangles: m, z up, at any place.
struct PlantSource {
  std::string name;
  std::vector<Vec3f> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
  /// The class that it stands for, as large as it is; otherwise it is scaled into the classes.
  std::optional<elements::Class> label = {};
};

/// Options of `mesh_primitives`.
struct MeshPrimitiveOptions {
  SizeRules sizes;
  int sizes_per_class = 3;        ///< Heights to which a plant is scaled within a class.
  double most_scaling = 2;        ///< A plant is made at most so much larger or smaller ...
  double tallest_tree_m = 16;     ///< Where the tallest class ends, and ...
  double lowest_shrub_m = 0.15;   ///< ... where the lowest begins.
  double cell_m = 2;              ///< Side of the cells of patches.
  int cells_per_size = 2;         ///< Cells of patches of each height.
  size_t most_triangles = 60000;  ///< A cell of a patch gets no further plant from here on.
  double range_sigma_m = 0.02;    ///< σ of the Gaussian noise on ranges.
  uint64_t seed = 1;
};

/// Scales plants and sorts them into the classes. Plants from `sizes.tree_m` on are trees, others
/// shrubs; each comes in every class of its kind, at heights spread evenly over the class, as far
/// as `most_scaling` allows (where that leaves a class empty, the plant that needs least stands
/// in). A cell of a patch holds shrubs of its height, turned and placed at random, until their
/// discs would cover it. Pose and box as `extract` has them: foot under the centroid, x along the
/// longer principal axis of the vertices, box bottom on the ground. Triangles are opaque. Throws
/// `std::invalid_argument` for a plant without triangles or without height.
std::vector<Primitive> mesh_primitives(const std::vector<PlantSource>& plants,
                                       const MeshPrimitiveOptions& options = {});

}  // namespace underbrush::primitives
