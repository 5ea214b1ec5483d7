/// \file
/// Measurement of the objects of a labelled log: their places and sizes.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/primitives/ground_surface.hpp"
#include "underbrush/primitives/placed_object.hpp"

namespace underbrush::primitives {

/// Options of `measure_objects`.
struct MeasureOptions {
  double quantile = 0;  ///< The box holds the points from this quantile to 1 − it along each axis
                        ///< (0.05 in the code of [tallavajhula18]'s authors); 0 holds all points.
  double cell_m = 2;  ///< m; patches are cut into cells of this side, along the axes of the world.
  size_t min_points = 5;  ///< Objects and cells with fewer points are left out.
};

/// The measured objects, and counts of the objects and hits that were left out.
struct MeasuredObjects {
  std::vector<PlacedObject> objects;  ///< In order of instance; the cells of a patch in order of
                                      ///< place.
  size_t without_instance = 0;        ///< Hits with an object's class that belong to no object.
  size_t few_points = 0;  ///< Objects and cells left out because they have too few points.
  size_t off_ground = 0;  ///< Objects and cells left out because there is no ground mesh beneath
                          ///< them.
};

/// Throws `FormatError`, which calls the log `file`, unless the log has the columns `class` (in the
/// set "underbrush") and `instance`. Rewinds the log and reads its first chunk.
void require_objects(const std::string& file, BeamSource& log);

/// Returns where points lie in five layers, to the millimetre as files keep it. Throws
/// `std::invalid_argument` where there are none.
PointLayers layers_of(std::vector<Vec3> points);

/// A function for the progress of a pass over a log, called with (done, total).
using MeasureProgress = std::function<void(size_t, size_t)>;

/// Measures the objects of a log that has the columns `class` (in the set "underbrush") and
/// `instance`. An object has the class of most of its points. The box of a cell is the cell's
/// square, up to its highest point. Of the headings that fit (two of an object, four of a cell) it
/// is the one at which the log's beams come from y < 0 on average, so that a primitive which takes
/// the place of another object is seen from where it was measured. Reads the log twice; memory
/// grows with the number of objects. Throws `std::invalid_argument` for a log without these
/// columns, a quantile outside [0, 0.5) or a cell that is not positive.
MeasuredObjects measure_objects(BeamSource& labelled, const GroundSurface& ground,
                                const MeasureOptions& options,
                                const MeasureProgress& progress = {});

/// A return of an object.
struct ObjectHit {
  Vec3 point, direction;  ///< The end point (m) and the unit direction of the beam, world.
  elements::Class label;
  uint32_t instance;  ///< 0 = none.
};

/// Calls `visit` with each hit that has an object's class, in the log's order. Reads the log once,
/// from its beginning. Throws `std::invalid_argument` for a log without the columns `class` (in the
/// set "underbrush") and `instance`.
void for_each_object_hit(BeamSource& labelled, const std::function<void(const ObjectHit&)>& visit,
                         const MeasureProgress& progress = {});

}  // namespace underbrush::primitives
