/// \file
/// The regions of a world that are open, within a budget of memory.
#pragma once
#include <optional>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/regions/world_folder.hpp"

namespace underbrush::regions {

/// The reach of the rays of a log's beams.
struct Reach {
  double range_m = 0;   ///< m; no ray ends farther.
  double spread_m = 0;  ///< m; at that range, the distance of a ray from its beam's axis.
};

/// Chooses the regions of a world that are open while its beams are answered one after another.
/// Beside those that beams need, those around them are opened ahead, and those that were needed
/// most recently stay open.
class OpenRegions {
 public:
  /// `world` must outlive it. `memory_bytes` is the memory for the world, the common part of its
  /// regions included.
  OpenRegions(const WorldFolder& world, uint64_t memory_bytes);

  /// Opens the regions that the beams [begin, end) of a log need, and returns the largest `end` of
  /// those tried (the log's end, and half as many beams again and again) whose regions fit into the
  /// memory. Throws `DataError` where those of a single beam do not.
  size_t open_for(const BeamLog& beams, size_t begin, const Reach& reach);
  /// Returns the open regions, ascending, if `open_for` has changed them since this was called
  /// last.
  std::optional<std::vector<uint32_t>> changed();

 private:
  uint64_t bytes_of(const std::vector<uint32_t>& regions) const;
  void open(const std::vector<uint32_t>& needed);
  std::vector<uint32_t> around(const std::vector<uint32_t>& regions) const;

  const WorldFolder& world_;
  uint64_t memory_bytes_, for_regions_;
  CellMap<Cell2, uint32_t> place_;     // of each square in the index
  std::vector<uint64_t> last_needed_;  // when each region was needed last; 0 = never
  uint64_t now_ = 0;
  std::vector<bool> is_open_;
  bool changed_ = true;
};

/// Throws the `DataError` that `what` ("the regions of ... take") needs `bytes` of memory, more
/// than the `memory_bytes` that are allowed.
[[noreturn]] void throw_too_little_memory(const std::string& what, uint64_t bytes,
                                          uint64_t memory_bytes);

/// The memory for a world of regions unless another is given.
inline constexpr const char* kMemory = "2GiB";
inline constexpr const char* kMemoryHelp = "Largest memory of the loaded regions of a world";

/// Reads an amount of memory such as "2GiB", "500MiB" or "1e9" (bytes). Throws
/// `std::invalid_argument`.
uint64_t memory_of(const std::string& text);

}  // namespace underbrush::regions
