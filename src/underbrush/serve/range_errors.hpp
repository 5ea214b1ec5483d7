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

/// The ranges of a log less those of another, row by row, and the errors of their packets: the mean
/// of the absolute errors of a packet's beams that hit in both logs, [tallavajhula18] eq. 1.
class RangeErrors {
 public:
  /// Reads both logs. Throws `DataError` where they do not have the same beams: equal numbers of
  /// rows, and directions that differ by less than 0.01 rad.
  RangeErrors(const std::filesystem::path& log, const std::filesystem::path& other);
  /// Returns two errors (float32, m) for each point of some nodes of the first log's octree, one
  /// node after the other, 16 MiB at most: that of its range, which is `kFalseHit` where the other
  /// log has a miss, and that of its packet, which is `kFalseHit` where no beam of the packet hits
  /// in both.
  std::string of_nodes(const OctreeFile& octree, const std::vector<uint32_t>& nodes) const;

 private:
  void close_packet(size_t begin);

  std::vector<float> error_m_, packet_error_m_;
};

}  // namespace underbrush::serve
