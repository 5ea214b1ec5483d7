/// \file
/// This file has the expectation step: one pass over a log under a model, which gives the
/// likelihood of the held-out beams and sums what the other beams say about each element.
#pragma once
#include <functional>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/fit/element_sums.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::fit {

/// The rule by which beams are held out from learning. Beams are grouped by scan, packet and
/// azimuth in steps of 1/256 of a quarter turn; about one group in `one_in` is held out, chosen by
/// a hash. Neighbouring beams thus stay together, and the order of the beams has no effect.
struct HeldOut {
  unsigned one_in = 20;  ///< 0 holds out nothing.
  uint64_t seed = 1;
  /// Whether beam `i` of the log is held out.
  bool operator()(const BeamLog& log, size_t i) const;
};

/// A source that leaves out the held-out beams of another source. The other source must outlive it,
/// and is read once by the constructor to count the beams.
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

/// The result of a pass over a log. Likelihoods are means of −log f over beams, in nats, as in
/// `metrics::score`.
struct Expectation {
  size_t training_beams = 0, held_out_beams = 0;
  double training_nll = 0, held_out_nll = 0;
  ElementSums sums;  ///< Sums over the training beams.
  /// Share of the training beams that returned from what no element explains.
  double stray_hits = 0;
};

/// Reads all beams of `source` once and evaluates them under `model`. `soft` has the outlier
/// shares under which credit is given to elements; the likelihoods are under
/// `trace::kReportedOutliers`, as those of the score are. `progress(done, total)` may be empty. The
/// model must outlive the sums of the result.
Expectation expect(const elements::Model& model, BeamSource& source, const HeldOut& held_out,
                   const trace::OutlierShares& soft,
                   const std::function<void(size_t, size_t)>& progress = {});

}  // namespace underbrush::fit
