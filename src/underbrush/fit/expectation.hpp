/// \file
/// This file has the expectation step: one pass over a log under a model, which gives the
/// likelihood of the held-out beams and sums what the other beams say about each element.
#pragma once
#include <functional>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/fit/element_sums.hpp"
#include "underbrush/fit/meetings.hpp"
#include "underbrush/trace/ray_likelihood.hpp"

namespace underbrush::fit {

/// The result of a pass over a log. Likelihoods are means of −log f over beams, in nats, as in
/// `metrics::score`.
struct Expectation {
  size_t training_beams = 0, held_out_beams = 0;
  size_t held_out_hits = 0;
  double training_nll = 0, held_out_nll = 0;
  ElementSums sums;  ///< Sums over the training beams.
  /// Share of the training beams that returned from what no element explains.
  double stray_hits = 0;
};

/// Exact sums over the beams of a pass.
struct PassTotals {
  FixedSum training, held_out;  ///< Σ −log f. Each is below 20, so the sum does not overflow.
  FixedSum stray_hits;
  FixedSum training_beams, held_out_beams, held_out_hits;
  std::array<MeshNoise, 2> noise;  ///< The ground's and the surface's.

  void add(const PassTotals& other);
};

/// Computes the shares of a block's beams under a model by the ray model with outliers:
///   f(z) = (1 − ε_h − ε_m) Σ_k w_k N(z; t_k, σ_k²) + ε_h / R
///   P(miss) = (1 − ε_h − ε_m) ∏_k (1 − p_k) + ε_m,   w_k = p_k ∏_{j<k} (1 − p_j)
/// z is the beam's range, R is `max_range_m`, and k counts the elements that the beam meets in
/// order of range. Shares are under `soft`: r_k ∝ w_k N(z; t_k, σ_k²) is the probability that
/// element k returned the beam, and Σ_{j>k} r_j that it went through element k; for a miss that is
/// the probability that it met nothing. The likelihoods of the totals are under
/// `trace::kReportedOutliers`, as those of the score are.
PassTotals find_shares(const ModelForm& model, const BeamBlock& block,
                       const trace::OutlierShares& soft, double max_range_m, BlockShares& shares);

/// Makes one pass over listed beams under `model`, which must be within the bounds of the lists.
/// `soft` has the outlier shares under which credit is given to elements. `progress(done, total)`
/// may be empty.
Expectation expect(const elements::Model& model, const Meetings& meetings,
                   const trace::OutlierShares& soft,
                   const std::function<void(size_t, size_t)>& progress = {});

/// The same for the beams of a log, which is searched for it.
Expectation expect(const elements::Model& model, BeamSource& source, const HeldOut& held_out,
                   const trace::OutlierShares& soft);

}  // namespace underbrush::fit
