/// \file
/// This file learns the map of observed space of a log, and the density of unknown space.
#pragma once
#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::calibrate {

/// The options of `learn_observed_space`.
struct ObservedSpaceOptions {
  double cell_m = 1;       ///< Side of the cells of the map; 0 = no map.
  double min_range_m = 0;  ///< m; returns nearer than this are of the vehicle.
};

/// Keeps the map of the space that the beams of a log crossed in its model, and the density κ of
/// matter in unknown space (`elements::ObservedSpace`).
///
/// κ is learnt from the log itself. It is divided into two parts, the earlier and the later half of
/// its scans, or quarters of the horizon where the sensor stands in one place. The beams of each
/// part are followed through the space that is unknown to the other:
///
///     κ(h, r) = (beams that ended there + ν) / (their path + ν / κ(h)),   ν = 5 beams,
///
/// by height h above the ground, which is known to the other part, too, and range r; κ(h) is the
/// ratio for all ranges. Beams without a return count with their path above the ground, up to the
/// greatest range of a return or 4 km. Nothing is learnt without a ground. The log is read four
/// times. The result has the same bits for any number of threads.
void learn_observed_space(elements::Model& model, BeamSource& log,
                          const ObservedSpaceOptions& options);

/// Adds the space that the beams of a further log crossed to the map of a model that has one. κ
/// stays as it is.
void update_observed_space(elements::Model& model, BeamSource& log, double min_range_m);

}  // namespace underbrush::calibrate
