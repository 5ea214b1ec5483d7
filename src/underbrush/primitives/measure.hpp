/// \file
/// The objects of a labelled log: where they stand and how large they are.
#pragma once
#include <functional>
#include <map>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/primitives/ground_surface.hpp"
#include "underbrush/primitives/placed_object.hpp"

namespace underbrush::primitives {

/// Options of `measure_objects`.
struct MeasureOptions {
  double quantile = 0;    ///< The box holds the points from this quantile to 1 − it, in each axis
                          ///< (0.05 in the code of [tallavajhula18]'s authors); 0 holds all.
  double cell_m = 2;      ///< Patches are cut into cells of this side, along the axes of the world.
  size_t min_points = 5;  ///< Objects and cells with fewer points are left out.
};

/// The objects, and what was left out.
struct MeasuredObjects {
  std::vector<PlacedObject> objects;  ///< By instance; cells of a patch by place.
  size_t without_instance = 0;        ///< Hits of an object's class that belong to no object.
  size_t few_points = 0;              ///< Objects and cells left out.
  size_t off_ground = 0;              ///< Objects and cells that stand off the ground mesh.
};

/// Called with (done, total).
using MeasureProgress = std::function<void(size_t, size_t)>;

/// Measures the objects of a log that has the columns `class` (ours) and `instance`. An object has
/// the class of most of its points. The box of a cell is the cell's square, up to its highest
/// point. Reads the log once; memory grows with the number of objects. Throws
/// `std::invalid_argument` for a log without these columns, a quantile outside [0, 0.5) or a cell
/// that is not positive.
MeasuredObjects measure_objects(BeamSource& labelled, const GroundSurface& ground,
                                const MeasureOptions& options,
                                const MeasureProgress& progress = {});

/// Column `name` at row i as a number, 0 below it.
uint32_t label_at(const ExtraColumn& column, size_t i);

/// Calls `visit` for each hit of a log with an object's class, in the log's order: its end point,
/// class and instance (0 = none). Reads the log once, from its start. Throws
/// `std::invalid_argument` for a log without the columns `class` (ours) and `instance`.
void for_each_object_hit(BeamSource& labelled,
                         const std::function<void(const Vec3&, elements::Class, uint32_t)>& visit,
                         const MeasureProgress& progress = {});

}  // namespace underbrush::primitives
