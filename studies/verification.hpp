/// The parts of the study of [kim12]: clouds of one target compared by ranges and by planes.
#pragma once
#include <array>
#include <filesystem>
#include <functional>

#include "studies/study.hpp"
#include "underbrush/core/beam_log.hpp"
#include "studies/plane_fit.hpp"
#include "studies/range_histogram.hpp"
#include "studies/registration.hpp"
#include "studies/solid.hpp"

namespace underbrush::studies {

/// Perpendicular distances (m) of points from a plane.
struct Distances {
  size_t points = 0;
  double mean_m = 0, sigma_m = 0;  ///< Mean and standard deviation of the absolute distances.
  double offset_m = 0;             ///< Mean of the signed ones.
};
Distances distances_from(const Plane& plane, const std::vector<Vec3>& points);

/// One patch of the target: the real scan's plane, and how far both clouds are from it.
struct PatchFigures {
  size_t face = 0;
  Plane plane;
  HeightPlane height;  ///< z over x to the right and y forward, as [kim12] table 3.
  Distances real, simulated;
};

/// What two clouds are compared with.
struct CloudPair {
  std::vector<Vec3> real;  ///< m, in the scanner's frame: ranges are distances from its origin.
  std::vector<Vec3> simulated;  ///< m, in the target's frame.
  Pose real_from_target;        ///< Roughly: to some degrees and 0.1 m.
};

/// Writes a pair as `--data` takes it: real.csv, simulated.csv, conjugates.csv.
void keep_pair(const std::filesystem::path& folder, const CloudPair& pair);

/// How the two compare.
struct PairFigures {
  std::vector<PatchFigures> patches;
  RangeHistograms histograms;           ///< Real, simulated.
  size_t real_points = 0, simulated_points = 0;  ///< On the target.
  IcpResult icp;
  Pose real_from_target;             ///< That of `icp`.
  std::vector<Vec3> conjugate_real;  ///< Corners where three of the real cloud's planes meet.
  /// `real_from_target` from the conjugate points alone; that of `icp` if they are fewer than
  /// three.
  Pose from_corners;
  double conjugate_rms_m = 0;        ///< What is left between the conjugate points.
  double corners_against_icp_m = 0;  ///< How far apart the two registrations lay the corners.

  double mean_distance_m() const;       ///< Of the simulated points, mean over the patches.
  double real_mean_distance_m() const;  ///< Of the real ones.
};

/// Lays the simulated cloud on the real one by iterated closest points, leaves out what lies off
/// the target, segments both by `faces` of the solid, fits planes to the real one's patches and
/// measures both clouds from them. The corners of planes that both clouds have, as conjugate
/// points, give the registration of the paper, for comparison. Throws `std::invalid_argument` where
/// fewer than three faces have points of both.
PairFigures compare(const Solid& solid, const std::vector<size_t>& faces, CloudPair pair,
                    double histogram_bin_m = 0.05);

/// A scan by the simulator: the catalogue's ILRIS-3D, sub-rays, waveform and echo, in the target's
/// frame. Its raster is shifted by `raster_phase(scan)` steps.
struct SimulatedScan {
  std::vector<Vec3> points;
  size_t shots = 0;
};
SimulatedScan simulated_scan(const Solid& solid, const Pose& target_from_scanner, int scan,
                             uint64_t seed);
/// A scan by the independent caster, in place of the real instrument's, in the scanner's frame; its
/// raster is shifted likewise.
std::vector<Vec3> instrument_scan(const Solid& target, const Pose& target_from_scanner,
                                  int scan, uint64_t seed);
/// Where within a step the raster of scan 0, 1, … begins: evenly spread, the first at (0, 0).
std::array<double, 2> raster_phase(int scan);

/// Where the scanner of [kim12] stands: 24.00 m before the middle of the miniature's front edge, at
/// which it looks down at 10°.
Pose miniature_from_scanner();

/// The thresholds of [kim12]: mean patch distance 3.1 mm, normalised histograms within 0.1 %.
std::vector<Check> pair_checks(const std::string& what, const PairFigures& figures);

/// The miniature; `change`, for tests, alters the solid that is simulated.
void add_miniature(const StudyRun& run, StudyResult& result,
                   const std::function<void(Solid&)>& change = {});
/// A user's own pair of clouds in `run.data`; false if there is none.
bool add_own_pair(const StudyRun& run, StudyResult& result);

/// Walls of a real scan: planes found in `train`, `test` simulated from them and measured.
struct WallFigures {
  struct Patch {
    Plane plane;
    size_t train_points = 0;
    Distances real, simulated;
  };
  std::vector<Patch> patches;
  RangeHistograms histograms;
  double range_sigma_m = 0;  ///< Of the simulated ranges: pooled over the planes of `train`.
};
WallFigures compare_walls(const BeamLog& train, const BeamLog& test, uint64_t seed);
/// The same on each folder of `run.data` that holds train.ply and test.ply.
void add_walls(const StudyRun& run, StudyResult& result);

/// The two histograms, counts and shares, as HTML.
std::string histogram_picture(const std::string& title, const RangeHistograms& h);

}  // namespace underbrush::studies
