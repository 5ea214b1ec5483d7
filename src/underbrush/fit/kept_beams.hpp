/// \file
/// A log that is read once and stays in memory if it is short.
#pragma once
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::fit {

/// The beams of another source. Beams that are read stay in memory if the whole log takes at most
/// some bytes; a longer log is read again in each pass.
class KeptBeams : public BeamSource {
 public:
  /// `source` must outlive it, and nothing else may read from it meanwhile.
  KeptBeams(BeamSource& source, size_t most_bytes) : source_(source), most_bytes_(most_bytes) {
    source.rewind();
  }
  const LogInfo& info() const override { return source_.info(); }
  size_t size() const override { return source_.size(); }
  void rewind() override;
  bool next(BeamLog& chunk) override;

 private:
  BeamSource& source_;
  size_t most_bytes_, at_ = 0;
  std::vector<BeamLog> kept_;  ///< The chunks read so far; the source is behind them.
  bool is_long_ = false;       ///< Whether the log is too long to be kept.
};

}  // namespace underbrush::fit
