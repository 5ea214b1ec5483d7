/// \file
/// This file gives the ground truth of a log for each of its scans.
#pragma once
#include <filesystem>
#include <map>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/perception/truth.hpp"

namespace underbrush::perception {

/// A labelled object at the time at which the sensor scanned it.
struct SeenBox {
  uint32_t scan = 0;
  double time_s = 0;
  TruthObject object;  ///< World frame.
};

/// The options of `LogTruth`.
struct LogTruthOptions {
  /// A fault of the recording that the log's beams were corrected for: labelled boxes are turned up
  /// by this angle about the sensor, as the beams were.
  double elevation_offset_rad = 0;
};

/// The ground truth of a log.
///
/// Labelled boxes are in the frame of the sensor at their scan. If the log is de-skewed, a box
/// belongs to the time at which the sensor scanned it, t = t_scan ± bearing / 2π · revolution, and
/// is placed with the pose of that time. Lists of objects are in the world's frame and are
/// interpolated.
class LogTruth {
 public:
  /// Reads the truth from a file of labelled boxes or lists of objects. Throws `FormatError`.
  LogTruth(const std::filesystem::path& file, const LogInfo& log,
           const LogTruthOptions& options = {});
  /// Takes lists of objects as truth.
  explicit LogTruth(const std::vector<ObjectList>& lists);

  /// Fills `frame` with the objects of a scan at its time.
  void at(uint32_t scan, double time_s, double cycle_s, TruthFrame& frame) const;
  /// The labelled boxes in the order of the file; none for lists of objects.
  const std::vector<SeenBox>& seen() const { return seen_; }

 private:
  void place(const std::vector<LabelledBox>& boxes, const LogInfo& log,
             const LogTruthOptions& options);

  bool is_labelled_ = false;
  std::map<uint32_t, std::vector<TruthObject>> by_scan_;
  std::vector<SeenBox> seen_;
  TruthSequence sequence_;
};

}  // namespace underbrush::perception
