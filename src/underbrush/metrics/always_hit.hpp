/// \file
/// The baseline *always hit*: every beam returns, at the median range of its ring.
#pragma once
#include <unordered_map>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::metrics {

/// The median range of each ring of a log, over the beams that returned. Beams that met something
/// that moved (`kMover`) do not count.
class RingMedians {
 public:
  /// Reads the log from its first beam to its last. Memory holds the range of every beam.
  explicit RingMedians(BeamSource& log);
  /// The median of a ring, m; the upper one of an even number. A ring without a return has the
  /// median of all rings, and a log without a return has `kMiss`.
  float of(uint16_t ring) const;

 private:
  std::unordered_map<uint16_t, float> of_ring_;
  float of_all_ = kMiss;
};

/// A source that answers the beams of a log with the medians of their rings. Its answers depend on
/// nothing else in the world, so a simulator must beat its scores. Intensities are 0.
class AlwaysHit : public BeamSource {
 public:
  /// `beams` must outlive it, and nothing else may read it meanwhile.
  AlwaysHit(RingMedians medians, BeamSource& beams) : medians_(std::move(medians)), beams_(beams) {}
  const LogInfo& info() const override { return beams_.info(); }
  size_t size() const override { return beams_.size(); }
  void rewind() override { beams_.rewind(); }
  bool next(BeamLog& chunk) override;

 private:
  RingMedians medians_;
  BeamSource& beams_;
};

/// The beams of `test` as `AlwaysHit` answers them, with the medians of `train`.
BeamLog always_hit(const BeamLog& train, const BeamLog& test);

}  // namespace underbrush::metrics
