/// \file
/// Constant errors of the ranges of a sensor's channels.
#pragma once
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush {

/// A channel whose measured ranges are the true ones plus a constant offset.
struct ChannelOffset {
  uint16_t ring = 0;
  double range_m = 0;           ///< Measured minus true range, m; over the channels the mean is 0.
  double standard_error_m = 0;  ///< m
};

/// The offsets of a sensor in ascending order of rings; a channel that is not there has none.
using ChannelOffsets = std::vector<ChannelOffset>;

/// Adds `sign` times the offset of its ring to the range of every hit. No range becomes shorter
/// than `kLeastRangeM`.
void add_offsets(const ChannelOffsets& offsets, double sign, BeamLog& beams);

/// The root mean square of the offsets, which is their standard deviation as the mean is 0, and
/// that of the standard errors; m. Both are 0 without offsets.
struct OffsetSpread {
  double sigma_m = 0, standard_error_m = 0;
};
/// Returns the spread of the offsets and of their standard errors.
OffsetSpread spread_of(const ChannelOffsets& offsets);

/// A log with true ranges instead of measured ones: the offsets are taken away.
class CorrectedBeams : public BeamSource {
 public:
  /// `source` must outlive it.
  CorrectedBeams(BeamSource& source, ChannelOffsets offsets)
      : source_(source), offsets_(std::move(offsets)) {}
  const LogInfo& info() const override { return source_.info(); }
  size_t size() const override { return source_.size(); }
  void rewind() override { source_.rewind(); }
  bool next(BeamLog& chunk) override;

 private:
  BeamSource& source_;
  ChannelOffsets offsets_;
};

}  // namespace underbrush
