/// \file
/// Learns the grain of a model's matter from the log that the model was fitted to.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush {
/// Estimates properties of a sensor and of the matter around it from a log: the channels' range
/// offsets, light and grain.
namespace calibrate {

/// The result of `learn_grain`. The roughness of a log is `RingRoughness::median`.
struct GrainReport {
  /// Whether the grain of the kind was learnt, and that of each class of `elements::Grain`. Matter
  /// that too few beams met keeps its grain.
  bool ellipsoids = false, meshes = false;
  std::vector<bool> classes;
  double real_m = 0;       ///< m; roughness of the log.
  double simulated_m = 0;  ///< m; roughness of a simulated log with the grain that was learnt.
  double anew_m = 0;       ///< m; roughness of a simulated log in which each beam draws anew.

  /// Whether any grain was learnt.
  bool learnt() const {
    return ellipsoids || meshes || std::find(classes.begin(), classes.end(), true) != classes.end();
  }
};

/// Sets the model's grain so that simulated ranges are as rough along the rings as those of the log
/// (`RingRoughness::geometric_mean`) where beams end on meshes, on ellipsoids of each class of the
/// grain and on other ellipsoids. Each is between 5 mm and 0.5 m. It also lowers `range_noise_m` so
/// that the smoothest quarters of both agree. Keyframes have no part in it. Reads the log once and
/// keeps about 30 000 beams of whole scans.
GrainReport learn_grain(elements::Model& model, BeamSource& log, uint64_t seed);

/// The result of `learn_grain_of_echoes`: mean numbers of echoes of the beams that have any.
struct EchoGrainReport {
  bool learnt = false;
  double real = 0, simulated = 0;
};

/// Sets the grain of the ellipsoids, between 1 mm and 0.5 m, so that simulated beams have as many
/// echoes as those of the log; the grain of classes keeps its proportion. About 20 000 beams of the
/// log are turned by half a step of azimuth, to directions that the log does not have, and
/// simulated with the instrument of `model.sensor`. A finer grain makes more echoes. Unless the
/// model is one of all echoes, the footprint of its beams is in it
/// (`simulate::Instrument::fitted_beam`). Nothing is learnt where the sensor is unknown, no beam of
/// the log has several echoes, or the model has no ellipsoids. Reads the log once; its rows are
/// echoes.
EchoGrainReport learn_grain_of_echoes(elements::Model& model, BeamSource& log, uint64_t seed);

}  // namespace calibrate
}  // namespace underbrush
