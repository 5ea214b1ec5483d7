/// The parts of the study of [kim12]: clouds of one target, compared by ranges and by planes.
#pragma once
#include <array>
#include <filesystem>
#include <functional>

#include "studies/plane_fit.hpp"
#include "studies/range_histogram.hpp"
#include "studies/registration.hpp"
#include "studies/solid.hpp"
#include "studies/study.hpp"
#include "underbrush/core/beam_log.hpp"

namespace underbrush::studies {

/// Perpendicular distances (m) of points from a plane.
struct Distances {
  size_t points = 0;
  double mean_m = 0, sigma_m = 0;  ///< Mean and standard deviation of the absolute distances.
  double offset_m = 0;             ///< Mean of the signed distances.
};
/// Measures the distances of points from a plane.
Distances distances_from(const Plane& plane, const std::vector<Vec3>& points);

/// A patch of the target: the plane of the real scan, and the distances of both clouds from it.
struct PatchFigures {
  size_t face = 0;
  Plane plane;
  HeightPlane height;  ///< z over x to the right and y forward, as in [kim12] table 3.
  Distances real, simulated;
  /// The planes of the points whose whole footprint lies on the face, and their numbers; none if
  /// one of the clouds has fewer than 30. At a grazing face the footprint is long.
  Plane inner_real, inner_simulated;
  size_t inner_real_points = 0, inner_simulated_points = 0;
};

/// Two clouds to compare.
struct CloudPair {
  std::vector<Vec3> real;  ///< m, in the scanner's frame; ranges are distances from its origin.
  std::vector<Vec3> simulated;  ///< m, in the target's frame.
  Pose real_from_target;        ///< An estimate, to some degrees and 0.1 m.
};

/// Writes a pair in the form that `--data` reads: real.csv, simulated.csv, conjugates.csv.
void keep_pair(const std::filesystem::path& folder, const CloudPair& pair);

/// The comparison of two clouds by one registration.
struct Registered {
  Pose real_from_target;
  std::vector<PatchFigures> patches;
  RangeHistograms histograms;  ///< Histograms of the real and the simulated cloud.

  double mean_distance_m() const;  ///< Mean distance of the simulated points, averaged over the
                                   ///< patches.
  double real_mean_distance_m() const;  ///< Mean distance of the real points, averaged over the
                                        ///< patches.
};

/// The comparison of two clouds.
struct PairFigures {
  size_t real_points = 0, simulated_points = 0;  ///< Number of points on the target.
  IcpResult icp;
  std::vector<Vec3> conjugate_real;  ///< Corners where three planes of the real cloud meet.
  double conjugate_rms_m = 0;        ///< Root mean square of the residuals of the conjugate points.
  double corners_against_icp_m = 0;  ///< Distance by which the two registrations differ at the
                                     ///< corners.
  Registered by_icp;                 ///< Comparison by iterated closest points.
  Registered by_corners;  ///< Comparison by the conjugate points alone, as in [kim12] §4.3. With
                          ///< fewer than three of them it is `by_icp`.
};

/// Compares two clouds. The simulated cloud is registered to the real one by iterated closest
/// points; points off the target are left out; both are segmented by `faces` of the solid; planes
/// are fitted to the patches, and the distances of both clouds from the real one's planes are
/// measured. The corners of planes that both clouds have serve as conjugate points for the paper's
/// registration, by which all is measured a second time. Throws `std::invalid_argument` where fewer
/// than three faces have points of both.
PairFigures compare(const Solid& solid, const std::vector<size_t>& faces, CloudPair pair,
                    double histogram_bin_m = 0.05);

/// A fault of a scanner, to test whether the verdict catches it. The defaults are no fault.
struct ScannerFault {
  double noise = 1;            ///< Factor of the standard deviation of the ranges.
  double bias_m = 0;           ///< Added to each range.
  double mirror_tilt_rad = 0;  ///< Lean of the axis about which the mirror scans upwards. A beam at
                               ///< elevation ε goes to azimuth + tilt · ε, and is reported without
                               ///< it.
};

/// A scan by the simulator in the target's frame: the catalogue's ILRIS-3D with sub-rays, waveform
/// and echo.
struct SimulatedScan {
  std::vector<Vec3> points;
  size_t shots = 0;
};
/// Scans the solid with the simulator. The raster is shifted by `raster_phase(scan)` steps.
SimulatedScan simulated_scan(const Solid& solid, const Pose& target_from_scanner, int scan,
                             uint64_t seed, const ScannerFault& fault = {},
                             bool all_sub_rays = false);
/// Scans the target with the independent simulator (`analytic_scan`), in place of the real
/// instrument; returns the points in the scanner's frame. The raster is shifted by
/// `raster_phase(scan)` steps.
std::vector<Vec3> instrument_scan(const Solid& target, const Pose& target_from_scanner, int scan,
                                  uint64_t seed);
/// Returns the place within a step at which the raster of scan 0, 1, … begins. The phases are
/// evenly spread; the first is (0, 0).
std::array<double, 2> raster_phase(int scan);

/// Returns the pose of the scanner of [kim12]: 24.00 m before the middle of the miniature's front
/// edge, at which it points down at 10°.
Pose miniature_from_scanner();

}  // namespace underbrush::studies
