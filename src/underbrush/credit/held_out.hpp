/// \file
/// This file chooses the beams that are held out from learning, and shares of a log.
#pragma once
#include "underbrush/core/beam_log.hpp"

namespace underbrush::credit {

/// The rule by which beams are held out from learning. Beams are grouped by scan, packet and
/// azimuth in steps of 1/256 of a quarter turn; about one group in `one_in` is held out, chosen by
/// a hash. Neighbouring beams thus stay together, and the order of the beams has no effect.
struct HeldOut {
  unsigned one_in = 20;  ///< 0 holds out nothing.
  uint64_t seed = 1;
  /// Whether beam `i` of the log is held out.
  bool operator()(const BeamLog& log, size_t i) const;
  /// Whether each beam of a log is held out.
  std::vector<uint8_t> of(const BeamLog& log) const;
};

/// Logs of at least so many beams are so long that a share of them is enough for some purposes.
inline constexpr size_t kLongLog = 1'000'000;

/// A share of the beams of a log, in eighths. A hash of its direction and range gives each beam one
/// of eight numbers, whatever its place in the log; the beams from `first` up to `last` belong to
/// the share.
struct BeamShare {
  static constexpr unsigned kParts = 8;
  unsigned first = 0, last = kParts;
  /// The number of beams of the log for which each beam of the share counts.
  unsigned weight() const { return kParts / (last - first); }
  bool is_all() const { return first == 0 && last == kParts; }
  bool operator==(const BeamShare&) const = default;
  bool has(unsigned number) const { return number >= first && number < last; }
  bool has(const BeamLog& log, size_t i) const { return is_all() || has(number_of(log, i)); }
  /// The number of beam `i`, below `kParts`.
  static unsigned number_of(const BeamLog& log, size_t i);
};

/// A source that leaves out the held-out beams of another source, which must outlive it, and of a
/// long log (`kLongLog`) the beams outside of a share.
class TrainingSource : public BeamSource {
 public:
  TrainingSource(BeamSource& source, const HeldOut& held_out, BeamShare share = {})
      : source_(source),
        held_out_(held_out),
        share_(source.size() < kLongLog ? BeamShare() : share) {}
  const LogInfo& info() const override { return source_.info(); }
  /// The number of beams of the source, with those that are left out.
  size_t size() const override { return source_.size(); }
  void rewind() override { source_.rewind(); }
  bool next(BeamLog& chunk) override;

 private:
  BeamSource& source_;
  HeldOut held_out_;
  BeamShare share_;
};

}  // namespace underbrush::credit
