/// \file
/// The grain of the matter: the size of the pieces that beams meet as one, such as a leaf, a twig
/// or a stone.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace underbrush::elements {

/// The grain of the ellipsoids of a class (`Ellipsoid::label`).
struct ClassGrain {
  uint32_t label = 0;
  double side_m = 0.05;  ///< m; side of the cells.
};

/// The grain of a model. Where the matter of a world is drawn once (`trace::Draws`), rays that pass
/// an element within a cell of this size meet the same matter at the same depth.
struct Grain {
  /// Number of classes that can have a grain of their own.
  static constexpr size_t kMostClasses = 7;

  double ellipsoid_m = 0.05;        ///< m; side of the cells of ellipsoids of all other classes.
  double mesh_m = 0.05;             ///< m; side of the cells of triangles.
  std::vector<ClassGrain> classes;  ///< At most `kMostClasses`, each label once.

  /// The place of a label in `classes`, counted from 1; 0 where it has no grain of its own.
  size_t place_of(uint32_t label) const {
    const auto at = std::find_if(classes.begin(), classes.end(),
                                 [&](const ClassGrain& c) { return c.label == label; });
    return at == classes.end() ? 0 : size_t(at - classes.begin()) + 1;
  }
  /// The side (m) at a place that `place_of` gives.
  double side_at(size_t place) const { return place ? classes[place - 1].side_m : ellipsoid_m; }
  /// Sets `ellipsoid_m`, and the sides of the classes in the same proportion.
  void scale_ellipsoids_to(double side_m) {
    for (ClassGrain& c : classes) c.side_m *= side_m / ellipsoid_m;
    ellipsoid_m = side_m;
  }
  /// Throws std::invalid_argument unless the sides are positive and `classes` is as described.
  void check() const;
};

/// The default grain (m) of the class with this name, for models whose log gives no estimate: the
/// width of its leaves, blades or needles, or the size over which the surface of a solid thing is
/// even.
double usual_grain_m(std::string_view class_name);

}  // namespace underbrush::elements
