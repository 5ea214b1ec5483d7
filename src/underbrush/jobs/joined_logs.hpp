/// \file
/// Logs that are read as one. It is internal to the module.
#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "underbrush/io/log_file.hpp"

namespace underbrush::jobs {

/// The logs of pieces, one after the other. The first chunk has `first_beams` beams, as that of the
/// whole command has, because the writer of a PLY scales its colours by its first chunk.
class JoinedLogs : public BeamSource {
 public:
  /// Throws `FormatError`.
  JoinedLogs(std::vector<std::filesystem::path> files, size_t first_beams);
  const LogInfo& info() const override { return info_; }
  size_t size() const override { return size_; }
  void rewind() override;
  bool next(BeamLog& chunk) override;

 private:
  void open();
  bool read(BeamLog& chunk);
  bool first(BeamLog& chunk);

  std::vector<std::filesystem::path> files_;
  size_t first_beams_, size_ = 0;
  LogInfo info_;
  size_t at_ = 0;  ///< The number of the open file.
  std::unique_ptr<io::LogReader> reader_;
  BeamLog rest_;  ///< Rows that were read with the first chunk and are not of it.
  bool begun_ = false;
};

}  // namespace underbrush::jobs
