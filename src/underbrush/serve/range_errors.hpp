/// \file
/// Two logs of the same beams, compared beam by beam.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/serve/octree.hpp"

namespace underbrush::serve {

/// Stands for the error of a hit where the other log has a miss.
inline constexpr float kFalseHit = 1e9f;

/// The ranges of a log less those of another, row by row.
class RangeErrors {
 public:
  /// Reads both logs. Throws `DataError` where they do not have the same beams: equal numbers of
  /// rows, and directions that differ by less than 0.01 rad.
  RangeErrors(const std::filesystem::path& log, const std::filesystem::path& other);
  /// Returns the errors (float32, m; `kFalseHit` where the other log has a miss) of the points of
  /// some nodes of the first log's octree, one node after the other; 16 MiB at most.
  std::string of_nodes(const OctreeFile& octree, const std::vector<uint32_t>& nodes) const;

 private:
  std::vector<float> error_m_;
};

}  // namespace underbrush::serve
