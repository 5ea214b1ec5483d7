/// \file
/// This file reads the ground truth of a recording and interpolates its objects in time.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "underbrush/perception/objects.hpp"

namespace underbrush::perception {

/// A labelled box of a scan, in the sensor's frame.
struct LabelledBox {
  uint32_t frame = 0;  ///< Number of the scan.
  TruthObject object;  ///< Its id is the number of the track in the file, plus one.
};

/// Whether a CSV file has labelled boxes: the columns frame, track_id, class, cx, cy, cz, yaw,
/// length, width and height.
bool is_labelled_box_file(const std::filesystem::path& path);
/// Reads labelled boxes. Throws `FormatError`.
std::vector<LabelledBox> read_labelled_boxes(const std::filesystem::path& path);

/// The ground truth over time.
class TruthSequence {
 public:
  /// Frames may be in any order; `std::invalid_argument` is thrown where two have the same time.
  explicit TruthSequence(std::vector<TruthFrame> frames);
  /// Takes lists of objects as ground truth.
  explicit TruthSequence(std::span<const ObjectList> lists);

  /// Fills `frame` with the objects at a time. An object that is in the frames before and after is
  /// interpolated; one that is in one of them only is taken from there, if that frame is at most
  /// `tolerance_s` away.
  void at(double time_s, double tolerance_s, TruthFrame& frame) const;
  const std::vector<TruthFrame>& frames() const { return frames_; }

 private:
  std::vector<TruthFrame> frames_;
};

/// A frame of the truth as a list of objects, seen from a vehicle. All are measured and exist.
ObjectList list_of_truth(const TruthFrame& frame, const Pose& world_from_vehicle);

}  // namespace underbrush::perception
