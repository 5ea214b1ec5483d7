/// \file
/// Composition of scenes from primitives along an annotation.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "underbrush/elements/scene_file.hpp"
#include "underbrush/primitives/annotation.hpp"
#include "underbrush/primitives/choose.hpp"
#include "underbrush/primitives/ground_surface.hpp"
#include "underbrush/primitives/primitive_set.hpp"

namespace underbrush::primitives {

/// Options of `compose`.
struct ComposeOptions {
  uint64_t seed = 1;
  Choice choose = Choice::kBest;
  size_t nearest = 1;  ///< Each object draws one of this many primitives that fit best.
  bool scale = false;  ///< Whether a primitive is scaled to the box by the least-squares factor.
  /// Number of objects that stand for each annotated object of the class. Below 1 some objects are
  /// left out; above 1 more are added beside the annotated ones.
  std::map<elements::Class, double> density;
};

/// Reads words CLASS=FACTOR as `ComposeOptions::density`. Throws `std::invalid_argument` for a
/// class that does not exist and a factor that is not in [0, 100].
std::map<elements::Class, double> densities_of(const std::vector<std::string>& words);

/// A composed scene, and counts of the objects that were placed and left out.
struct Composition {
  elements::Scene scene;
  elements::SceneInfo info;
  /// The number of the object that each instance but the first stands for, counted as in `objects`:
  /// an annotation's number where it has no patch larger than a cell.
  std::vector<uint32_t> object_of;
  size_t objects = 0;     ///< Annotated objects; a patch counts as its cells.
  size_t placed = 0;      ///< Instances without the ground.
  size_t off_ground = 0;  ///< Objects left out because there is no ground mesh beneath them.
  /// Objects left out because the set has no primitive of their kind, by class.
  std::map<std::string, size_t> left_out;
  /// Objects placed with a primitive of another size, by class.
  std::map<std::string, size_t> borrowed;
  /// m; mean distance between the boxes of the objects and those of the primitives.
  double mean_box_distance_m = 0;
};

/// A function for the progress of `compose`, called with (done, total).
using ComposeProgress = std::function<void(size_t, size_t)>;

/// Composes a scene part by part, for `compose` and for scenes that are larger than memory.
class Composer {
 public:
  /// The scene's ground gets the parameters of `ground` and no elements. `set` must outlive this.
  /// Throws `std::invalid_argument` as `compose` does.
  Composer(const elements::Model& ground, const PrimitiveSet& set, const ComposeOptions& options);
  ~Composer();

  /// Adds objects that stand on a ground.
  void add(const GroundSurface& ground, const std::vector<PlacedObject>& objects,
           const ComposeProgress& progress = {});
  /// Forgets the objects below a line (m, world), which later objects do not come near.
  void forget_below(double y_m);
  /// The composition so far. A caller may take the instances with their labels and numbers out of
  /// it, all but the first, which is the ground's.
  Composition& result();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Composes a scene: for each (class, pose, box) of the annotation it places a primitive of the
/// class (`Choice`), with its foot on the ground, and with `Choice::kBest` and without `scale`
/// adapts it to the object (`adapted`) where that is possible. Where the set has no primitive of
/// the class, one of the same kind (shrub, tree, patch) is taken. A patch larger than a cell is
/// filled cell by cell. Instance 0 and model 0 are the ground. Throws `FormatError` where a
/// primitive cannot be read, and `std::invalid_argument` for a density that is negative or above
/// 100.
Composition compose(const Annotation& annotation, const elements::Model& ground,
                    const PrimitiveSet& set, const ComposeOptions& options,
                    const ComposeProgress& progress = {});

}  // namespace underbrush::primitives
