/// \file
/// This file chooses the beams that are held out from learning.
#pragma once
#include "underbrush/core/beam_log.hpp"

namespace underbrush::fit {

/// The rule by which beams are held out from learning. Beams are grouped by scan, packet and
/// azimuth in steps of 1/256 of a quarter turn; about one group in `one_in` is held out, chosen by
/// a hash. Neighbouring beams thus stay together, and the order of the beams has no effect.
struct HeldOut {
  unsigned one_in = 20;  ///< 0 holds out nothing.
  uint64_t seed = 1;
  /// Whether beam `i` of the log is held out.
  bool operator()(const BeamLog& log, size_t i) const;
  /// The same of each beam of a log.
  std::vector<uint8_t> of(const BeamLog& log) const;
};

/// A source that leaves out the held-out beams of another source, which must outlive it.
class TrainingSource : public BeamSource {
 public:
  TrainingSource(BeamSource& source, const HeldOut& held_out)
      : source_(source), held_out_(held_out) {}
  const LogInfo& info() const override { return source_.info(); }
  /// The number of beams of the source, held-out ones included.
  size_t size() const override { return source_.size(); }
  void rewind() override { source_.rewind(); }
  bool next(BeamLog& chunk) override;

 private:
  BeamSource& source_;
  HeldOut held_out_;
};

}  // namespace underbrush::fit
