/// \file
/// The beams of a log whose rows are echoes.
#pragma once
#include "underbrush/core/beam_log.hpp"

namespace underbrush {

/// The beams of another source, each with its first echo alone (`keep_first_echoes`). A log without
/// the column `kEchoColumn` is not changed.
class FirstEchoes : public BeamSource {
 public:
  /// Reads `source` once if its rows are echoes, to count its beams. `source` must outlive it.
  explicit FirstEchoes(BeamSource& source);
  const LogInfo& info() const override { return source_.info(); }
  /// The number of beams.
  size_t size() const override { return beams_; }
  void rewind() override { source_.rewind(); }
  bool next(BeamLog& chunk) override;

 private:
  BeamSource& source_;
  size_t beams_;
};

}  // namespace underbrush
