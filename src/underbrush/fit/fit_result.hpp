/// \file
/// The result of a fit: a model, a report and the record of its tiles.
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
  size_t mover_points = 0;           ///< Points left out because of the flag `kMover`.
  size_t near_points = 0;            ///< Points left out because nearer than `min_range_m`.
  size_t far_points = 0;             ///< Points beyond the maximum range of the log.
  size_t carved_triangles = 0;       ///< Triangles dropped because of `surface.carve`.
  size_t thinned_points = 0;         ///< Points left out because their tile was full.
  size_t unclustered_points = 0;     ///< Points in no cluster of at least `min_points`.
  size_t free_space_ellipsoids = 0;  ///< Ellipsoids dropped as free space.
  size_t tiles = 0;
  /// m; σ of the sensor's range of which the fit made use: that of the options, or less if a sensor
  /// that stands still showed less (`calibrate::range_noise_of`).
  double range_noise_m = 0;
  likelihood::LikelihoodReport likelihood;  ///< Has steps only if the fitter is `likelihood`.
  calibrate::GrainReport grain;
  calibrate::LeafAngleReport leaf_angles;
  calibrate::SwayReport sway;
  calibrate::EchoGrainReport echo_grain;  ///< Learnt only from several echoes per beam.
  std::vector<std::string> warnings;
};

/// A model, the report of its fit, and the record that `update` needs.
struct FitResult {
  elements::Model model;
  FitReport report;
  FitRecord record;
  /// m²; `cluster::open_covariances` of the ellipsoids, zero for those that an update keeps; empty
  /// where the clustering was not told the spacing of the beams.
  std::vector<Eigen::Matrix3f> open;
};

/// Receives the progress of a fit: the name of the stage, the work done and the total.
using FitProgress = std::function<void(std::string_view, size_t, size_t)>;

}  // namespace underbrush::fit
