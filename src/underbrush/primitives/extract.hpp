/// \file
/// Extraction of primitives from a model, along the objects of a labelled log.
#pragma once
#include <string>
#include <vector>

#include "underbrush/elements/model.hpp"
#include "underbrush/primitives/measure.hpp"

namespace underbrush::primitives {

/// The placement of a plant mesh in a primitive: x_primitive = at + R(yaw) scale R(turn) (x_file −
/// foot), with rotations about z and x_file in metres with z up.
struct PlantPlacement {
  std::string plant;         ///< Name of the plant: its file, or that of the generator.
  Vec3 foot = Vec3::Zero();  ///< m; centroid of the vertices in x and y, lowest z.
  double turn_rad = 0;       ///< Turns the longer principal axis in x and y onto x.
  double scale = 1;
  double yaw_rad = 0;
  Vec3 at = Vec3::Zero();  ///< m.
};

/// A primitive π = (c, M) of [tallavajhula18] §IV: the elements of an object at the identity pose,
/// with the object's box.
struct Primitive {
  elements::Class label = elements::Class::kUnknown;
  Box box;
  elements::Model model;                    ///< It has no ground; its origin is the object's foot.
  PlacedObject source;                      ///< The object as it was measured in the log.
  std::vector<PlantPlacement> plants = {};  ///< The plant meshes of which it is made, if any.
  uint32_t origin = 0;                      ///< Index into the origins of its set, if it has any.
  std::string given_name = {};              ///< The name that a person gave it, if any.
};

/// The elements that an object takes.
enum class Membership {
  kBox,  ///< Elements whose centre lies in the object's box ([tallavajhula18]); neighbours may
         ///< share some.
  kOwn,  ///< Elements of the box that lie among the object's own points, so that none is taken
         ///< twice.
};

/// Options of `extract`.
struct ExtractOptions {
  MeasureOptions measure;
  Membership membership = Membership::kOwn;
  /// Ellipsoids at which a smaller share of the beams that met them ended are left out. Thin matter
  /// has a small hit probability and stops few beams elsewhere, too, so 0 keeps it.
  double free_space_below = 0;
  size_t min_elements = 1;  ///< Objects of fewer elements are left out.
};

/// The primitives, and counts of the objects and elements that were left out.
struct ExtractResult {
  std::vector<Primitive> primitives;
  MeasuredObjects measured;        ///< `objects` are in the order of the log.
  size_t empty = 0;                ///< Objects that hold no element.
  size_t few_elements = 0;         ///< Objects left out with fewer than `min_elements` elements.
  size_t free_space = 0;           ///< Ellipsoids left out because they are free space.
  size_t elements = 0, taken = 0;  ///< Elements of the model without its ground, and those of them
                                   ///< that a primitive took.
};

/// Cuts primitives out of the model, along the objects of the labelled log from which it was
/// fitted. Reads the log up to three times. An element is located by its centre (mean of an
/// ellipsoid, centroid of a triangle), which may lie up to 0.1 m outside of the object's box if the
/// membership is `kOwn`. Elements below a box but above the ground, on the lower side of a slope,
/// count as within. Throws as `measure_objects` does, and `std::invalid_argument` for a share that
/// is not in [0, 1].
ExtractResult extract(const elements::Model& model, BeamSource& labelled,
                      const ExtractOptions& options, const MeasureProgress& progress = {});

}  // namespace underbrush::primitives
