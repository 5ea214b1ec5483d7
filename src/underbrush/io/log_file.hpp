/// \file
/// Underbrush's log on disk: a binary ray cloud PLY (CSIRO raycloudtools) that other tools can
/// read, with additional columns and comments. Layout: docs/reference/formats.md.
#pragma once
#include <filesystem>
#include <memory>
#include <string>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::io {

/// Reads a ray cloud PLY in chunks. Throws `FormatError` as soon as it finds damage.
class LogReader : public BeamSource {
 public:
  explicit LogReader(const std::filesystem::path& path, size_t chunk_size = 1 << 20);
  ~LogReader() override;
  const LogInfo& info() const override;
  size_t size() const override;
  void rewind() override;
  bool next(BeamLog& chunk) override;
  /// Returns the rows [first, first + n) of the file, wherever `next` is; several threads may call
  /// it at once. Throws `std::invalid_argument` where there are no such rows, and `FormatError` for
  /// a row that `next` would leave out.
  BeamLog rows(size_t first, size_t n) const;
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
  bool next(BeamLog& chunk) override;

 private:
  size_t beams_ = 0;
};

/// Options of `LogWriter`.
struct LogWriterOptions {
  bool double_coordinates = true;  ///< Stores end points as double (millimetres at any distance),
                                   ///< else as float.
  bool limits_from_data = false;   ///< A longer range of a hit raises the log's maximum range.
};

/// Writes a ray cloud PLY in chunks. Nothing appears at `path` before `close()`.
class LogWriter {
 public:
  LogWriter(const std::filesystem::path& path, const LogInfo& info, const std::string& provenance,
            const LogWriterOptions& options = {});
  /// Removes what was written if `close()` was not called.
  ~LogWriter();
  /// Appends beams. All chunks must carry the same extra columns as the first one.
  void write(const BeamLog& chunk);
  /// Completes the header and renames the file to its final path. Throws `IoError`.
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Reads a whole log into memory. Throws `FormatError`.
BeamLog read_log(const std::filesystem::path& path);
/// Writes a whole log, atomically. Throws `IoError`.
void write_log(const std::filesystem::path& path, const BeamLog& log, const std::string& provenance,
               const LogWriterOptions& options = {});

}  // namespace underbrush::io
