/// A standing scanner before a target, many measurements of each direction: the experiment of
/// [deschaud12] §V.A and its score.
#pragma once
#include <string>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/metrics/bearing_range.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::studies {

/// How a target is scanned.
struct StaticScanOptions {
  std::string sensor = "velodyne-hdl64e";
  double distance_m = 8;
  double sensor_height_m = 2;
  int bearings = 56;     ///< Directions of a laser, an encoder's count apart, about x: 5°.
  int most_lasers = 64;  ///< Of those that meet the target, the middle ones.
  /// Directions around those that test also train: lasers, bearings. No model ends in the picture.
  int margin_lasers = 2, margin_bearings = 4;
  int measurements = 1500;       ///< Of each direction.
  int sub_rays = 16;             ///< Of a beam in reality.
  double range_sigma_m = 0.005;  ///< [deschaud12] §V.C, measured with this sensor on a plane.
  uint64_t seed = 1;
};

/// Logs of one target: every fifth measurement trains, the others test. Directions are those that
/// the encoder reports; the true azimuth lies evenly within a count about it.
struct StaticScan {
  std::string target;
  bool porous = true;
  size_t directions = 0;  ///< Of the test log.
  double step_rad = 0;    ///< Of the encoder.
  sensor::Sensor sensor;
  BeamLog train, test;
};
StaticScan scan_target(const std::string& target, const StaticScanOptions& options);

/// Histogram of a scan's beams at encoder × range resolution.
metrics::BearingRangeHistogram histogram_of(const StaticScan& scan, const BeamLog& beams);

/// Mean over the lasers of the distances of their own histograms.
double mean_distance_of_lasers(const metrics::BearingRangeHistogram& real,
                               const metrics::BearingRangeHistogram& simulated);

/// The training beams in the directions of the test log.
BeamLog without_margin(const StaticScan& scan);

/// The test beams answered by the model, `draws` times each: by rays on the axis, or drawn from the
/// beam's cone.
metrics::BearingRangeHistogram simulated_histogram(const StaticScan& scan,
                                                   const elements::Model& model, bool random_ray,
                                                   int draws, uint64_t seed);

}  // namespace underbrush::studies
