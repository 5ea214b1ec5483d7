/// \file
/// Scenes composed of primitives along an annotation.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "underbrush/elements/scene_file.hpp"
#include "underbrush/primitives/annotation.hpp"
#include "underbrush/primitives/primitive_set.hpp"

namespace underbrush::primitives {

/// Options of `compose`.
struct ComposeOptions {
  uint64_t seed = 1;
  size_t nearest = 1;  ///< Draw among this many primitives with the nearest boxes.
  bool scale = false;  ///< Scale the primitive to the box, by the factor of least squares.
  /// How many objects of a class stand for each that is annotated: below 1 some are left out; above
  /// 1 others are added beside them.
  std::map<elements::Class, double> density;
};

/// A scene, and what happened.
struct Composition {
  elements::Scene scene;
  elements::SceneInfo info;
  size_t objects = 0;                      ///< Annotated objects, patches counted by their cells.
  size_t placed = 0;                       ///< Instances but the ground.
  size_t off_ground = 0;                   ///< Left out: they stand off the ground mesh.
  std::map<std::string, size_t> left_out;  ///< By class: the set has no primitive of its kind.
  std::map<std::string, size_t> borrowed;  ///< By "CLASS": placed with primitives of another size.
  double mean_box_distance_m = 0;          ///< Between the boxes asked for and those placed.
};

/// Called with (done, total).
using ComposeProgress = std::function<void(size_t, size_t)>;

/// For each (class, pose, box) the primitive of that class with the nearest box ‖extents −
/// extents'‖ ([tallavajhula18] §IV) as an instance, its foot on the ground. Where the set has no
/// primitive of the class, one of the same kind (shrub, tree, patch) is taken. A patch larger than
/// a cell is filled cell by cell. Instance 0 and model 0 are the ground. Throws `FormatError` where
/// a primitive cannot be read, `std::invalid_argument` for a density that is negative or above 100.
Composition compose(const Annotation& annotation, const elements::Model& ground,
                    const PrimitiveSet& set, const ComposeOptions& options,
                    const ComposeProgress& progress = {});

}  // namespace underbrush::primitives
