/// A standing scanner that measures a target many times in each direction: the experiment of
/// [deschaud12] §V.A and its score.
#pragma once
#include <string>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/metrics/bearing_range.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::studies {

/// Options of `scan_target`.
struct StaticScanOptions {
  std::string sensor = "velodyne-hdl64e";
  double distance_m = 8;
  double sensor_height_m = 2;
  int bearings = 56;     ///< Directions of each laser about x, one encoder count apart: 5°.
  int most_lasers = 64;  ///< If more lasers meet the target, the middle ones are used.
  /// Directions around those of the test that are in the training too, by lasers and by bearings,
  /// so that no model ends within the picture.
  int margin_lasers = 2, margin_bearings = 4;
  int measurements = 1500;       ///< Measurements of each direction.
  int sub_rays = 16;             ///< Sub-rays of each beam of the measurement.
  double range_sigma_m = 0.005;  ///< m; measured by [deschaud12] §V.C with this sensor on a plane.
  uint64_t seed = 1;
};

/// Logs of one target. Every fifth measurement is for training, the others are for testing.
/// Directions are those that the encoder reports; the true azimuth is uniform within a count about
/// it.
struct StaticScan {
  std::string target;
  bool porous = true;
  size_t directions = 0;  ///< Number of directions in the test log.
  double step_rad = 0;    ///< Angle of an encoder count.
  sensor::Sensor sensor;
  BeamLog train, test;
};
/// Scans a target.
StaticScan scan_target(const std::string& target, const StaticScanOptions& options);

/// Returns the histogram of a scan's beams at the resolution of the encoder and of the range.
metrics::BearingRangeHistogram histogram_of(const StaticScan& scan, const BeamLog& beams);

/// Returns the mean over the lasers of the distance between their own histograms.
double mean_distance_of_lasers(const metrics::BearingRangeHistogram& real,
                               const metrics::BearingRangeHistogram& simulated);

/// Returns the training beams in the directions of the test log.
BeamLog without_margin(const StaticScan& scan);

/// Simulates each test beam on the model `draws` times, by rays on its axis or drawn from its cone,
/// with matter that is drawn once for all of them or anew for each, and returns the histogram.
metrics::BearingRangeHistogram simulated_histogram(const StaticScan& scan,
                                                   const elements::Model& model, bool random_ray,
                                                   bool once, int draws, uint64_t seed);

}  // namespace underbrush::studies
