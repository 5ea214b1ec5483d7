/// \file
/// Waveforms of all beams in one binary file, written as they come.
#pragma once
#include <filesystem>
#include <vector>

#include "underbrush/core/file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/pipeline/simulate_options.hpp"

namespace underbrush::pipeline {

/// A file of waveforms (.waves; docs/reference/formats.md). It appears when it is closed.
class WaveformFile {
 public:
  /// Throws `IoError`.
  explicit WaveformFile(const std::filesystem::path& path);
  /// Appends waveforms. Throws `IoError`.
  void append(const std::vector<simulate::BeamWaveform>& waveforms);
  /// Writes the number of beams into the header and closes the file. Throws `IoError`.
  void close();

 private:
  io::AtomicFile atomic_;
  OutputFile file_;
  uint64_t beams_ = 0;
};

}  // namespace underbrush::pipeline
