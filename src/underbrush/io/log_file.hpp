/// \file
/// Our log on disk: a ray cloud PLY (CSIRO raycloudtools, binary) that others' tools read, with
/// further columns and comments of ours. Layout: docs/reference/formats.md.
#pragma once
#include <filesystem>
#include <memory>
#include <string>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::io {

/// Reads a ray cloud PLY in chunks. Throws `FormatError` at the first sign of damage.
class LogReader : public BeamSource {
 public:
  explicit LogReader(const std::filesystem::path& path, size_t chunk_size = 1 << 20);
  ~LogReader() override;
  const LogInfo& info() const override;
  size_t size() const override;
  void rewind() override;
  bool next(BeamLog& chunk) override;
  /// The provenance JSON of the program that wrote it; empty if none.
  const std::string& provenance() const;
  /// Records left out so far and why (count by reason), e.g. "not finite", "zero-length ray".
  const std::map<std::string, size_t>& skipped() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The beams of a log, one row each: of several echoes the first (`keep_first_echoes`). To count
/// the beams, a log with several echoes a beam is read twice.
class BeamReader : public LogReader {
 public:
  explicit BeamReader(const std::filesystem::path& path, size_t chunk_size = 1 << 20);
  size_t size() const override { return beams_; }
  bool next(BeamLog& chunk) override;

 private:
  size_t beams_ = 0;
};

/// How a log is written.
struct LogWriterOptions {
  bool double_coordinates = true;  ///< End points as double (millimetres at any distance) or float.
};

/// Writes a ray cloud PLY in chunks. Nothing stands at `path` until `close()`.
class LogWriter {
 public:
  LogWriter(const std::filesystem::path& path, const LogInfo& info, const std::string& provenance,
            const LogWriterOptions& options = {});
  /// Without `close()`, removes what was written.
  ~LogWriter();
  /// Appends beams. All chunks must carry the same extra columns as the first.
  void write(const BeamLog& chunk);
  /// Completes the header and renames the file into place.
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The whole log in memory.
BeamLog read_log(const std::filesystem::path& path);
/// Writes the whole log.
void write_log(const std::filesystem::path& path, const BeamLog& log, const std::string& provenance,
               const LogWriterOptions& options = {});

}  // namespace underbrush::io
