/// \file
/// The layout of compact logs, for their writer and reader. It is internal to the module.
#pragma once
#include <cmath>
#include <string_view>
#include <variant>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::compact {

/// The first bytes of a file, of which the last one is the version.
inline constexpr std::string_view kMagic = {"UBLOG\r\n\1", 8};
/// The last bytes of a file.
inline constexpr std::string_view kEndMagic = {"UBLOGEND", 8};
inline constexpr size_t kTrailerBytes = 40;
inline constexpr size_t kFactsBytes = 17 * 8;  ///< Size of a chunk's entry in the index.

inline constexpr size_t kMostExpansion = 1024;  ///< Decoded bytes of a chunk for each of the file.
inline constexpr size_t kMostColumns = 256;     ///< Extra columns.
inline constexpr size_t kMostNameBytes = 1024;
inline constexpr size_t kMostIndexBytes = size_t(1) << 28;

/// Returns the bytes of a row in memory.
inline size_t row_bytes(const BeamLog& log) {
  size_t bytes = sizeof(Vec3) + sizeof(Vec3f) + 2 * sizeof(float) + sizeof(double) + 2 + 4 + 4 + 1;
  for (const auto& entry : log.extra) {
    bytes += std::visit([](const auto& c) { return sizeof(c[0]); }, entry.second);
  }
  return bytes;
}

/// Returns why a log cannot hold a row, beyond the faults that `BeamLog::check` finds, or null if
/// it can hold the row.
inline const char* fault_of(const BeamLog& log, size_t i) {
  const double range = log.range_m[i];
  if (log.is_hit(i) && !(range >= kLeastRangeM && range < kMaxCoordinate)) {
    return "a range is not above 0 and finite";
  }
  return std::isfinite(log.intensity[i]) ? nullptr : "an intensity is not finite";
}

}  // namespace underbrush::compact
