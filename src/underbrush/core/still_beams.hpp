/// \file
/// A log without the beams that met something that moved.
#pragma once
#include "underbrush/core/beam_log.hpp"

namespace underbrush {

/// Leaves out each beam that has a return with the flag `kMover`, with all its echoes. A log
/// without such flags passes as it is.
class StillBeams : public BeamSource {
 public:
  /// `source` must outlive it.
  explicit StillBeams(BeamSource& source) : source_(source) {}
  const LogInfo& info() const override { return source_.info(); }
  /// The number of beams of the source, marked ones included.
  size_t size() const override { return source_.size(); }
  void rewind() override;
  bool next(BeamLog& chunk) override;
  /// The number of rows left out, the most in one reading of the source.
  size_t left_out() const { return left_out_; }

 private:
  BeamSource& source_;
  size_t now_ = 0, left_out_ = 0;
};

}  // namespace underbrush
