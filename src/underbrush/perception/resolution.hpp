/// \file
/// This file merges the segments of objects that a sensor cannot resolve, and splits them again
/// ([rosenberger20] §5).
#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "underbrush/perception/segments.hpp"

namespace underbrush::perception {

/// The options of `Resolution`.
struct ResolutionOptions {
  bool enabled = false;
  double least_gap_m = 0.3;   ///< m; segments nearer to each other than this become one.
  double gap_rad = 0.0087;    ///< The distance grows by this with the range (0.5°).
  double split_factor = 1.5;  ///< Merged segments split when their gap is so much larger.

  /// Throws `std::invalid_argument` where a value is out of range.
  void check() const;
};

/// Two objects that are one segment, by their numbers, the smaller one first.
using MergedPair = std::pair<uint64_t, uint64_t>;

/// Merges segments of different objects whose points are nearer to each other than the resolution.
/// The points go to the object that was listed already, or else to the one with more points, or
/// else to the first. Its state is the pairs that are merged.
class Resolution {
 public:
  /// Throws `std::invalid_argument` for options out of range.
  explicit Resolution(const ResolutionOptions& options = {});
  /// Changes `segments.of_point`; the caller gathers the points again. Returns whether it changed.
  /// `ids` and `listed` have an entry for each segment.
  bool merge(std::span<const uint64_t> ids, std::span<const uint8_t> listed, const Vec3& viewpoint,
             Segments& segments);
  const std::vector<MergedPair>& merged() const { return merged_; }
  void reset() { merged_.clear(); }

 private:
  /// The points of a segment that distances are measured between, and the circle around them.
  struct Sample {
    uint32_t begin, end;
    Vec3 centre;
    double radius;
  };
  void sample(const Segments& segments);
  double gap(const Sample& a, const Sample& b) const;

  ResolutionOptions options_;
  std::vector<MergedPair> merged_, now_;
  std::vector<Sample> samples_;
  std::vector<Vec3> points_;
  std::vector<uint32_t> target_;
};

}  // namespace underbrush::perception
