/// \file
/// A log without the beams that met something that moved.
#pragma once
#include "underbrush/core/beam_log.hpp"

namespace underbrush {

/// The beams of another source without those that have a return with the flag `kMover`; all echoes
/// of such a beam are left out. A log without such flags is not changed.
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
