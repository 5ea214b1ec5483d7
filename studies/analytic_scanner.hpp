/// A second lidar simulator, slow and simple, to check the first against. It intersects planes and
/// tests points in polygons in double precision, with a beam and random numbers of its own. It
/// shares no code with trace, sensor, radiometry or core/rng, but only the solid and the numbers of
/// the instrument's data sheet.
#pragma once
#include <cstdint>
#include <vector>

#include "studies/solid.hpp"
#include "underbrush/core/pose.hpp"

namespace underbrush::studies {

/// Options of `analytic_scan`. The defaults are those of the ILRIS-3D of [kim12] table 2 before a
/// target at 24.00 m.
struct AnalyticScanOptions {
  uint64_t seed = 1;
  double half_field_rad = 3 * M_PI / 180;  ///< Half of the square field about the forward axis.
  double step_rad = 0.007 / 24.0;          ///< 7 mm at 24.00 m.
  double azimuth_phase = 0.5, elevation_phase = 0.5;  ///< Phase of the raster, in steps.
  double range_sigma_m = 0.007;
  double range_step_m = 0.001;
  double exit_m = 0.0127, divergence_rad = 170e-6;  ///< Full widths at half power.
  double least_energy = 3e-4;  ///< Least share of the beam's energy, cos θ included, that is
                               ///< detected.
};

/// The scan that `analytic_scan` returns.
struct AnalyticScan {
  std::vector<Vec3> points;  ///< m, in the scanner's frame: x forward, y left, z up.
  size_t shots = 0;
};

/// Scans a solid with one echo for each shot. The range is the mean over the surfaces in the
/// footprint, weighted by its energy, as a pulse longer than the target's depth measures it; normal
/// noise is added, and the range is rounded.
AnalyticScan analytic_scan(const Solid& solid, const Pose& target_from_scanner,
                           const AnalyticScanOptions& options = {});

}  // namespace underbrush::studies
