/// \file
/// Real walls in the study of [kim12]: planes of every other beam of a real scan answer the beams
/// between them, so that neither poses nor moving things have a part in it.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "studies/planar_patches.hpp"
#include "studies/verification.hpp"
#include "underbrush/core/beam_log.hpp"

namespace underbrush::studies {

/// The source of the answers to the beams on a wall.
enum class WallSource {
  kFaces,      ///< The planes of the other beams, each with the spread of those beams about it.
  kDataSheet,  ///< The same planes, with the noise of the sensor's data sheet.
  kFit,        ///< The default model, fitted to the other beams.
};

/// A wall of one scan.
struct Wall {
  Plane plane;          ///< Plane of every other beam, which is simulated.
  Plane real;           ///< Plane of the beams between, as measured.
  Plane simulated;      ///< Plane of the same beams, as simulated.
  size_t points = 0;    ///< Beams that hit within 15 cm of the plane, measured and simulated.
  double offset_m = 0;  ///< m; mean of simulated − measured range.
  /// Sums of g (simulated − measured range) and of g², where g is the change of the range with the
  /// lean of the mirror; their ratio estimates the lean (rad).
  double lean_sum = 0, lean_weight = 0;
};

/// A scan cut into two halves, beam by beam along each ring, and the planes of the first half.
class WallScan {
 public:
  /// Finds the largest upright planes, 3 to 40 m away. Throws `std::invalid_argument` where there
  /// are none.
  explicit WallScan(const BeamLog& scan);

  /// Answers the beams of the second half whose neighbours of the first half on both sides lie on
  /// one wall, and compares them with the measurements, on each wall that keeps at least 50.
  std::vector<Wall> compare(WallSource source, const ScannerFault& fault, uint64_t seed) const;

 private:
  elements::Model faces() const;
  elements::Model fitted(uint64_t seed) const;

  BeamLog first_, second_;
  Vec3 origin_;
  Mat3 sensor_from_world_ = Mat3::Identity();
  std::vector<PlanarPatch> patches_;
  std::vector<uint32_t> wall_;  ///< The wall of each beam of the second half.
};

/// A mean over scans, with the bounds of its 99 % confidence interval (Student's t).
struct Bounded {
  double mean = 0, low = 0, high = 0;
};
/// Returns the mean of one value per scan. Throws `std::invalid_argument` for fewer than two.
Bounded bounded(const std::vector<double>& values);

/// The walls of several scans, simulated against measured.
struct WallFigures {
  size_t scans = 0, walls = 0, beams = 0;
  Bounded spread;    ///< Spread about the plane, simulated / measured; geometric mean.
  Bounded offset_m;  ///< Mean of simulated − measured range.
  Bounded lean_rad;  ///< Lean of the mirror, estimated from the differences of the ranges.
};
/// Sums up the walls of each scan.
WallFigures wall_figures(const std::vector<std::vector<Wall>>& scans);

/// Returns the two-sided checks of the walls: the intervals must lie within 0.8 and 1.25 for the
/// spread, ± 5 mm for the offset and ± 0.25° for the lean, half of the faults that must be caught.
std::vector<Check> wall_checks(const std::string& what, const WallFigures& figures);

/// Adds the walls of each log of `run.data` with at least four scans, and a simulator of each
/// fault, which must be caught. Logs without walls are noted.
void add_walls(const StudyRun& run, StudyResult& result);

}  // namespace underbrush::studies
