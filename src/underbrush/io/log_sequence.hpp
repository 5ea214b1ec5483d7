/// \file
/// Several logs as one.
#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "underbrush/io/log_file.hpp"

namespace underbrush::io {

/// The beams of several logs one after another, as one log in one world frame. No more than one of
/// the files is open. Numbers of scans and of packets are counted on from the number of rows before
/// their log (modulo 2³²), so that those of different logs differ where no log has more of them
/// than rows.
class LogSequence : public BeamSource {
 public:
  /// Opens each file once. Throws `FormatError` where one is damaged, named twice, or does not fit
  /// to the first one: the logs must be of the same sensor, with the same maximum range and labels.
  explicit LogSequence(std::vector<std::filesystem::path> files);

  const std::vector<std::filesystem::path>& files() const { return files_; }
  /// The facts that all logs have in common, with the scans of all. The sequence has misses, and is
  /// de-skewed, where each log is.
  const LogInfo& info() const override { return info_; }
  /// The number of rows of all files.
  size_t size() const override { return starts_.back(); }
  void rewind() override;
  bool next(BeamLog& chunk) override;
  /// From now on, `next` gives the rows [first, end) of all files alone, and does not open files
  /// without one of them.
  void keep_rows(size_t first, size_t end);
  /// Returns how many records of the files read so far were left out, by reason.
  std::map<std::string, size_t> skipped() const;

 private:
  void add(const LogReader& reader, const std::filesystem::path& file);
  void open(size_t file);

  std::vector<std::filesystem::path> files_;
  std::vector<size_t> starts_{0};  ///< The rows before each file, and those of all.
  LogInfo info_;
  size_t first_ = 0, end_ = 0;
  size_t at_ = 0;  ///< The file that is open.
  std::unique_ptr<LogReader> reader_;
  std::vector<std::map<std::string, size_t>> skipped_;  ///< The records left out, by file.
};

}  // namespace underbrush::io
