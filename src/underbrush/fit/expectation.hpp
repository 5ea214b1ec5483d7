/// \file
/// One pass over a log under a model: the likelihood of the beams held out, and what the others say
/// of each element.
#pragma once
#include <functional>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/fit/element_sums.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::fit {

/// Which beams of a log are kept back: all those that point into the same 1/256 of a quarter turn
/// in the same packet of the same scan go together, one such group in `one_in` by a hash. The order
/// of the beams does not matter.
struct HeldOut {
  unsigned one_in = 20;  ///< 0: none.
  uint64_t seed = 1;
  bool operator()(const BeamLog& log, size_t i) const;
};

/// The beams of a source that are not held out. The source must outlive it; it is read once to
/// count them.
class TrainingSource : public BeamSource {
 public:
  TrainingSource(BeamSource& source, const HeldOut& held_out);
  const LogInfo& info() const override { return source_.info(); }
  size_t size() const override { return size_; }
  void rewind() override { source_.rewind(); }
  bool next(BeamLog& chunk) override;

 private:
  BeamSource& source_;
  HeldOut held_out_;
  size_t size_ = 0;
};

/// Results of a pass. Likelihoods are means of −log f a beam.
struct Expectation {
  size_t training_beams = 0, held_out_beams = 0;
  double training_nll = 0, held_out_nll = 0;
  ElementSums sums;       ///< Of the training beams.
  double stray_hits = 0;  ///< Share of the training beams that returned what no element explains.
};

/// Reads all beams of `source` once. `soft` are the outlier shares under which credit is given; the
/// likelihoods reported are under `trace::kReportedOutliers`, as the score's are. The model must
/// outlive the sums.
Expectation expect(const elements::Model& model, BeamSource& source, const HeldOut& held_out,
                   const trace::OutlierShares& soft,
                   const std::function<void(size_t, size_t)>& progress = {});

}  // namespace underbrush::fit
