/// \file
/// This file takes the cycles of a log as merged clouds.
#pragma once
#include <optional>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/perception/alignment.hpp"

namespace underbrush::perception {

/// The options of `CycleReader`.
struct CycleOptions {
  AlignmentOptions alignment;
  double min_range_m = 0;  ///< m; nearer hits are left out, such as those on the own vehicle.
  /// m; height of a log's sensor above the ground, so that the vehicle's frame stands there. It has
  /// no effect with a rig.
  double sensor_height_m = 0;
};

/// Reads a log scan by scan: each is a cycle. The hits become clouds of the sensors in their own
/// frames (IF1), and `Alignment` merges them (IF2).
///
/// A log of a rig has the column `sensor`, and its scans have the poses of the vehicle. Any other
/// log is one of a single sensor, whose frame is that of the vehicle, except for its height.
class CycleReader {
 public:
  /// The source must outlive the reader, which rewinds it. Throws `DataError` for a log
  /// without beams, for times of scans that do not differ, and, when read, for one with the column
  /// `sensor` and no rig.
  CycleReader(BeamSource& source, std::optional<Rig> rig, const CycleOptions& options = {});

  /// Reads the next cycle. Returns false at the end.
  bool next(MergedCloud& cloud);
  /// The number of the cycle's scan in the log.
  uint32_t scan() const { return scan_; }
  /// The pose of the log's scans: of the vehicle in a rig's log, else of the sensor.
  const Pose& world_from_scan() const { return world_from_scan_; }
  /// The time between scans, s; 0 for a single scan.
  double cycle_s() const { return cycle_s_; }

 private:
  bool fill();
  const ScanInfo& info_of(uint32_t scan) const;
  void add(size_t i, const ScanInfo& info);

  BeamSource& source_;
  CycleOptions options_;
  bool is_rig_, is_deskewed_ = false;
  std::vector<ScanInfo> scans_;
  Alignment alignment_;
  Trajectory path_;  ///< The vehicle's poses.
  double cycle_s_ = 0;
  BeamLog chunk_;
  const std::vector<uint8_t>* sensor_ = nullptr;
  size_t at_ = 0;
  uint32_t scan_ = 0;
  Pose world_from_scan_;
  std::vector<SensorCloud> clouds_;
};

}  // namespace underbrush::perception
