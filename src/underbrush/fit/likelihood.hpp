/// \file
/// The fitter `likelihood`: any model refined by expectation–maximisation on the ray model.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "underbrush/fit/expectation.hpp"
#include "underbrush/fit/maximisation.hpp"
#include "underbrush/fit/rearrangement.hpp"

namespace underbrush::fit {

/// Options of `refine`.
struct LikelihoodOptions {
  HeldOut held_out;
  int rounds = 12;             ///< Most rearrangements at first, and most steps after them.
  double least_gain = 0.0005;  ///< A step must lower the held-out −log f by this, nats a beam.
  /// Weight of "its return was lost" for a beam without one, when credit is given. Near 0 every
  /// lone miss makes what stands in its way permeable, which is the best likelihood; a simulation
  /// then loses beams of its own at places of its own, which is the worst F1. See
  /// docs/explanation/likelihood.md.
  double dropout = 0.4;
  /// How much more decided than the likeliest model the result is (`sharpened`). Above 1 a draw
  /// lies nearer to the measured return, and likelihood and CRPS get worse.
  double sharpness = 1;
  double range_noise_m = 0.02;
  MaximisationOptions maximisation;
  RearrangementOptions rearrangement;
};

/// One step that was tried.
struct LikelihoodStep {
  std::string name;  ///< start, density, maximise, rearrange
  size_t elements = 0;
  double training_nll = 0, held_out_nll = 0;  ///< Mean −log f a beam, as `metrics::score` takes it.
  bool accepted = false;
};

/// How a refinement went.
struct LikelihoodReport {
  size_t training_beams = 0, held_out_beams = 0;
  double stray_hits = 0;  ///< Estimated share of returns that no element explains.
  std::vector<LikelihoodStep> steps;
};

/// A refined model.
struct Refined {
  elements::Model model;
  LikelihoodReport report;
};

/// Refines `start` by steps, each of which must raise the likelihood of the beams held out or is
/// undone: densities for hit probabilities; rearrangements (`rearranged`), which never add to the
/// number of elements, for as long as they help; M-steps (`maximised`), every third time a
/// rearrangement. In the end the ellipsoids are `sharpened`. Reads the source once a step; memory
/// grows with the model. The same bits for any number of threads and any order of the beams.
/// Ellipsoids bounded by voxels are refused (`std::invalid_argument`): their means move.
/// `progress(stage, done, total)` may be empty.
Refined refine(const elements::Model& start, BeamSource& source, const LikelihoodOptions& options,
               const std::function<void(std::string_view, size_t, size_t)>& progress = {});

}  // namespace underbrush::fit
