/// \file
/// The formats of log files behind `LogReader` and `LogWriter`. It is internal to the module.
#pragma once
#include <memory>
#include <vector>

#include "underbrush/io/log_file.hpp"
#include "underbrush/io/log_layout.hpp"

namespace underbrush::io {

/// The reason for which a row is left out.
enum RowFault : uint8_t { kNoFault, kNotFinite, kZeroLength, kTooLarge };

/// The rows of an open log file.
class LogRows {
 public:
  virtual ~LogRows() = default;
  virtual const std::string& file() const = 0;
  virtual size_t size() const = 0;
  /// Returns a log without rows that has the file's extra columns.
  virtual const BeamLog& empty() const = 0;
  /// Reads the rows from `first` on into all rows of `out`, which has the columns of `empty()`. The
  /// row of a fault that is not `kNoFault` is to be left out. Several threads may call it at once.
  virtual void read(size_t first, BeamLog& out, std::vector<uint8_t>& fault) const = 0;
  /// Returns the ranges [first, end) of the rows outside of which none is in the window.
  virtual std::vector<std::pair<size_t, size_t>> ranges(const LogWindow&) const {
    return {{0, size()}};
  }

  LogComments comments;
};

/// Opens a ray cloud PLY. Throws `FormatError`.
std::unique_ptr<LogRows> open_ply_rows(const std::filesystem::path& path);

/// The file of a log that is being written.
class LogSink {
 public:
  virtual ~LogSink() = default;
  virtual void write(const BeamLog& chunk) = 0;
  /// Completes the file; `comments` holds the log's limits now.
  virtual void finish(const LogComments& comments) = 0;
};

/// Begins a file in `out`, which must outlive it.
std::unique_ptr<LogSink> begin_ply(OutputFile& out, const LogComments& comments,
                                   const LogWriterOptions& options);

/// The functions of compact logs.
struct CompactFormat {
  /// Whether the first bytes of a file are those of a compact log.
  bool (*is)(const std::filesystem::path& path);
  std::unique_ptr<LogRows> (*open)(const std::filesystem::path& path);
  /// Begins a file in `out`, which must outlive it.
  std::unique_ptr<LogSink> (*begin)(OutputFile& out, const LogComments& comments);
};
/// Whether this program reads compact logs and the file is one.
bool is_compact(const std::filesystem::path& path);

}  // namespace underbrush::io
