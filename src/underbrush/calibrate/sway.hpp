/// \file
/// Learns from a sensor that stands still whether the matter of a model stands still, too.
#pragma once
#include <cstdint>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::calibrate {

/// The result of `learn_sway`. `real_m` to `anew_m` are differences of the ranges of one direction
/// in successive scans from one place, in the log and in simulations of it: geometric means of |Δ
/// range| + 1 mm where both scans have a return.
struct SwayReport {
  bool stands = false;    ///< Whether successive scans of the log are from one place.
  size_t pairs = 0;       ///< Pairs of beams that repeat a direction.
  double interval_s = 0;  ///< s; the time between the beams of a pair, the median.
  double real_m = 0;      ///< m; the log's difference.
  double still_m = 0;     ///< m; the difference if all matter stands still.
  double anew_m = 0;      ///< m; the difference if each beam draws its own matter.
  /// Whether there were enough pairs and times to determine whether the matter sways.
  bool known = false;
};

/// Sets `sway_s` of the model, the correlation time T of its matter, where scans of the log repeat
/// the directions of the scan before from the same place (within 5 cm and 0.05°) and differ by over
/// 25 % more than a simulation with still matter does. T is the time with which the simulation
/// differs as much as the log, and at least the time from scan to scan. What the sensor's own
/// scatter does to a direction, such as the play of its encoder, counts as motion of the matter.
/// Otherwise `sway_s` becomes 0. Only beams that end on ellipsoids count, at least `kLeastPairs` of
/// `repeats_of` the log.
SwayReport learn_sway(elements::Model& model, BeamSource& log, uint64_t seed);

}  // namespace underbrush::calibrate
