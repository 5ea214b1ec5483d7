/// A second lidar simulator, slow and plain, to hold the first against: planes and point-in-polygon
/// in double precision, its own beam, its own random numbers. It shares no code with trace, sensor,
/// radiometry or core/rng: only the solid and the numbers of the instrument's data sheet.
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/core/pose.hpp"
#include "studies/solid.hpp"

namespace underbrush::studies {

/// The ILRIS-3D of [kim12] table 2, before a target at 24.00 m.
struct AnalyticScanOptions {
  uint64_t seed = 1;
  double half_field_rad = 3 * M_PI / 180;             ///< Square, about the forward axis.
  double step_rad = 0.007 / 24.0;                     ///< 7 mm at 24.00 m.
  double azimuth_phase = 0.5, elevation_phase = 0.5;  ///< Of the raster, in steps.
  double range_sigma_m = 0.007;
  double range_step_m = 0.001;
  double exit_m = 0.0127, divergence_rad = 170e-6;  ///< Full widths at half power.
  double least_energy = 3e-4;  ///< Share of the beam's energy, cos θ of it, that is detected.
};

/// What it sees.
struct AnalyticScan {
  std::vector<Vec3> points;  ///< Scanner frame: x forward, y left, z up, m.
  size_t shots = 0;
};

/// One echo a shot: the mean range of what the footprint meets, weighted with its energy, as a
/// pulse longer than the target is deep sees it; normal noise; rounded.
AnalyticScan analytic_scan(const Solid& solid, const Pose& target_from_scanner,
                           const AnalyticScanOptions& options = {});

}  // namespace underbrush::studies
