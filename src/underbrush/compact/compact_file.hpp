/// \file
/// The file of a compact log: chunks of rows one after the other, then an index of them with their
/// checksums, times and places. The layout is described in docs/reference/compact-log.md.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/file.hpp"

namespace underbrush {
/// Compact logs: the coding of their columns, their chunks and their index.
namespace compact {

/// The number of rows of every chunk of a file but the last one.
inline constexpr size_t kChunkRows = 1 << 16;

/// A box along the axes (m, world); empty where `least` is above `most`.
struct Box {
  Vec3 least = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 most = -least;

  void add(const Vec3& point) {
    least = least.cwiseMin(point);
    most = most.cwiseMax(point);
  }
  bool contains(const Vec3& point) const {
    return (point.array() >= least.array()).all() && (point.array() <= most.array()).all();
  }
  bool meets(const Box& other) const {
    return (least.array() <= other.most.array()).all() &&
           (other.least.array() <= most.array()).all();
  }
};

/// The entry of a chunk in the index.
struct ChunkFacts {
  uint64_t offset = 0, size = 0;  ///< Place and length in the file, bytes.
  uint64_t hash = 0;              ///< XXH3 of the chunk's bytes, 64 bits.
  uint64_t returns = 0;           ///< Rows with a return.
  double first_s = 0, last_s = 0;
  Box ends, origins;  ///< Boxes of the returns' end points and of all origins.
};

/// Whether the first bytes of a file are those of a compact log.
bool is_compact(const InputFile& file);

/// Writes rows to a file. The bytes depend on the rows alone, not on the pieces in which they come
/// or on the number of threads.
class Writer {
 public:
  /// Begins the file. `out` must outlive the writer; the poses of `info.scans` help to predict
  /// rows.
  Writer(OutputFile& out, const LogInfo& info);
  ~Writer();
  /// Appends rows, all of them with the extra columns of the first ones. Throws
  /// `std::invalid_argument` for columns that `BeamLog::check` refuses, and `DataError` for ranges
  /// or intensities that a log cannot hold.
  void write(const BeamLog& rows);
  /// Writes the index. `text` is kept for `Reader::text`.
  void finish(const std::string& text);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// An open file. Several threads may read rows at once.
class Reader {
 public:
  /// Reads the index. `file` must outlive the reader. Throws `FormatError` where the file is
  /// truncated or its index is damaged.
  explicit Reader(const InputFile& file);
  ~Reader();
  const std::string& text() const;
  size_t rows() const;
  const std::vector<ChunkFacts>& chunks() const;
  /// Returns a log without rows that has the file's extra columns.
  const BeamLog& empty() const;
  /// Reads the rows [first, first + out.size()) of the file into `out`, which has the columns of
  /// `empty()`. Throws `FormatError`, which names the chunk, where one of them is damaged.
  void read(size_t first, BeamLog& out) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace compact
}  // namespace underbrush
