/// \file
/// Primitives cut out of a model along the objects of a labelled log.
#pragma once
#include <string>
#include <vector>

#include "underbrush/elements/model.hpp"
#include "underbrush/primitives/measure.hpp"

namespace underbrush::primitives {

/// π = (c, M) of [tallavajhula18] §IV: the elements of an object at the identity pose, with the box
/// that it was cut along.
struct Primitive {
  elements::Class label = elements::Class::kUnknown;
  Box box;
  elements::Model model;  ///< No ground; its origin is the object's foot.
  PlacedObject source;    ///< Where it stood.
};

/// Which elements an object takes.
enum class Membership {
  kBox,  ///< Those whose centre lies in its box ([tallavajhula18]): neighbours may share some.
  kOwn,  ///< Of these, those that lie among its own points, so that no element is taken twice.
};

/// Options of `extract`.
struct ExtractOptions {
  MeasureOptions measure;
  Membership membership = Membership::kOwn;
  /// Ellipsoids at which a smaller share of the beams ended that met them are left out: where they
  /// were fitted, others stood behind them; elsewhere they stop beams that nothing would stop.
  double free_space_below = 0.1;
};

/// The primitives, and what was left out.
struct ExtractResult {
  std::vector<Primitive> primitives;
  MeasuredObjects measured;        ///< `objects` in the order of the log.
  size_t empty = 0;                ///< Objects that hold no element.
  size_t free_space = 0;           ///< Ellipsoids left out as free space.
  size_t elements = 0, taken = 0;  ///< Elements of the model but its ground; those in a primitive.
};

/// Cuts the model along the objects of the labelled log from which it was fitted. Reads the log
/// twice. An element counts by its centre (mean of an ellipsoid, centroid of a triangle); elements
/// beneath a box but above the ground, on the lower side of a slope, count as within. Throws as
/// `measure_objects` does, and for a share outside [0, 1].
ExtractResult extract(const elements::Model& model, BeamSource& labelled,
                      const ExtractOptions& options, const MeasureProgress& progress = {});

}  // namespace underbrush::primitives
