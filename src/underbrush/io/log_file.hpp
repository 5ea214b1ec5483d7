/// \file
/// Underbrush's log on disk, in one of two formats: a binary ray cloud PLY (CSIRO raycloudtools)
/// that other tools can read, with additional columns and comments (docs/reference/formats.md), and
/// the compact log, which is smaller and exact to the bit (docs/reference/compact-log.md).
#pragma once
#include <filesystem>
#include <limits>
#include <memory>
#include <string>

#include "underbrush/core/beam_window.hpp"

namespace underbrush::io {

/// Whether the name is one of a log of either format: it ends in .ply or .ublog.
bool is_log_name(const std::filesystem::path& path);

/// The choice of the rows of a log. By default all rows are wanted.
struct LogWindow {
  double first_s = -std::numeric_limits<double>::infinity();  ///< s; time of the first rows wanted.
  double last_s = std::numeric_limits<double>::infinity();    ///< s; time of the last rows wanted.
  /// m, world; where one of them is finite, only returns in the box are wanted, and no misses.
  Vec3 least = Vec3::Constant(-std::numeric_limits<double>::infinity());
  Vec3 most = -least;

  bool has_place() const { return !(least.array().isInf().all() && most.array().isInf().all()); }
  /// Whether row i of a log is wanted.
  bool has(const BeamLog& log, size_t i) const;
};

/// Reads a log of either format in chunks; the file's first bytes determine which. Throws
/// `FormatError` as soon as it finds damage.
class LogReader : public SeekableSource {
 public:
  explicit LogReader(const std::filesystem::path& path, size_t chunk_size = 1 << 20);
  ~LogReader() override;
  const LogInfo& info() const override;
  size_t size() const override;
  void rewind() override;
  /// Starts at the chunk that has row `row`. The logs of other programs, some rows of which may be
  /// no beams, are read from their start. Until `rewind`, `next` throws `FormatError` for a row
  /// that it would leave out.
  size_t seek(size_t row) override;
  bool next(BeamLog& chunk) override;
  /// From now on, `next` gives the rows [first, end) of the file alone, and does not read others.
  void keep_rows(size_t first, size_t end);
  /// Returns the rows [first, first + n) of the file, wherever `next` is; several threads may call
  /// it at once. Throws `std::invalid_argument` where there are no such rows, and `FormatError` for
  /// a row that `next` would leave out.
  BeamLog rows(size_t first, size_t n) const;
  /// Returns the rows in a window, in order. Of a compact log only those chunks are read that may
  /// hold one. Throws `FormatError`.
  BeamLog within(const LogWindow& window) const;
  /// Returns the provenance JSON of the program that wrote the log; empty if there is none.
  const std::string& provenance() const;
  /// Returns how many records were left out so far, by reason (e.g. "not finite", "zero-length
  /// ray").
  const std::map<std::string, size_t>& skipped() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Reads a log with one row for each beam: its first echo, or its miss (`keep_first_echoes`). A log
/// with several echoes a beam is read once more at the start, to count the beams.
class BeamReader : public LogReader {
 public:
  explicit BeamReader(const std::filesystem::path& path, size_t chunk_size = 1 << 20);
  size_t size() const override { return beams_; }
  /// Starts at the chunk that has beam `beam`, as above. A log with several echoes a beam is read
  /// from its start.
  size_t seek(size_t beam) override;
  bool next(BeamLog& chunk) override;

 private:
  size_t beams_ = 0;
};

/// Options of `LogWriter`.
struct LogWriterOptions {
  bool double_coordinates = true;  ///< A PLY stores end points as double (millimetres at any
                                   ///< distance), else as float.
  bool limits_from_data = false;   ///< A longer range of a hit raises the log's maximum range.
};

/// Writes a log in chunks: a compact log where the name ends in .ublog, else a ray cloud PLY.
/// Nothing appears at `path` before `close()`.
class LogWriter {
 public:
  LogWriter(const std::filesystem::path& path, const LogInfo& info, const std::string& provenance,
            const LogWriterOptions& options = {});
  /// Removes the unfinished file if `close()` was not called.
  ~LogWriter();
  /// Appends beams. All chunks must carry the same extra columns as the first one.
  void write(const BeamLog& chunk);
  /// Completes the header and renames the file to its final path. Throws `IoError`.
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

struct CompactFormat;
/// Returns the functions of compact logs; null in a program that is linked without them, as the
/// FMU.
const CompactFormat* compact_format();

/// Reads a whole log into memory. Throws `FormatError`.
BeamLog read_log(const std::filesystem::path& path);
/// Writes a whole log, atomically. Throws `IoError`.
void write_log(const std::filesystem::path& path, const BeamLog& log, const std::string& provenance,
               const LogWriterOptions& options = {});

}  // namespace underbrush::io
