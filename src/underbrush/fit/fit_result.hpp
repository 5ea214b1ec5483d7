/// \file
/// What a fit returns.
#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "underbrush/calibrate/grain.hpp"
#include "underbrush/calibrate/leaf_angles.hpp"
#include "underbrush/calibrate/sway.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/fit/fit_record.hpp"
#include "underbrush/likelihood/likelihood.hpp"

namespace underbrush::fit {

/// Counts and warnings of a fit.
struct FitReport {
  size_t beams = 0, hits = 0, misses = 0;
  size_t ground_points = 0, other_points = 0;
  size_t mover_points = 0;           ///< Left out because they have the flag `kMover`.
  size_t near_points = 0;            ///< Left out because they are nearer than `min_range_m`.
  size_t far_points = 0;             ///< Beyond the maximum range of the log.
  size_t carved_triangles = 0;       ///< Dropped because of `surface.carve`.
  size_t thinned_points = 0;         ///< Left out because their tile was full.
  size_t unclustered_points = 0;     ///< In no cluster of at least `min_points`.
  size_t free_space_ellipsoids = 0;  ///< Dropped as free space.
  size_t tiles = 0;
  likelihood::LikelihoodReport likelihood;  ///< Has steps only if the fitter is `likelihood`.
  calibrate::GrainReport grain;
  calibrate::LeafAngleReport leaf_angles;
  calibrate::SwayReport sway;
  calibrate::EchoGrainReport echo_grain;  ///< Learnt only from several echoes a beam.
  std::vector<std::string> warnings;
};

/// A model, the report of its fit, and what `update` needs to know of it.
struct FitResult {
  elements::Model model;
  FitReport report;
  FitRecord record;
};

/// Receives the progress of a fit: the name of the stage, the work done and the total.
using FitProgress = std::function<void(std::string_view, size_t, size_t)>;

}  // namespace underbrush::fit
