/// \file
/// This file has the expectation step, which is one pass over a log under a model. The pass sums
/// the statistics of each element over the training beams, and the likelihood of the model over the
/// held-out beams.
#pragma once
#include <functional>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/likelihood/element_sums.hpp"
#include "underbrush/likelihood/listed_beams.hpp"
#include "underbrush/trace/ray_likelihood.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::likelihood {

/// The result of a pass over the training beams.
struct Expectation {
  double nll = 0;  ///< The mean of −log f over beams, nats, as in `metrics::score`.
  ElementSums sums;
  double stray_hits = 0;  ///< Share of the beams with a return that no element explains.
};

/// Exact sums over the beams of a pass.
struct PassTotals {
  FixedSum loss;  ///< Σ −log f. Each term is below 20, so the sum does not overflow.
  FixedSum stray_hits;
  std::array<MeshNoise, 2> noise;  ///< The ground's and the surface's.

  void add(const PassTotals& other);
};

/// Exact sums of a pass over some training beams. The sums of the parts of a log, added in any
/// order, are the sums of the whole.
struct PassSums {
  ElementSums elements;
  PassTotals totals;
  uint64_t beams = 0;
};

/// The columns of the meetings of a run of beams.
class RunColumns {
 public:
  /// Makes room for `count` meetings.
  void resize(size_t count);
  MeetingColumns meetings();
  EllipsoidColumns ellipsoids();

 private:
  std::vector<float> numbers_;
  std::vector<uint32_t> places_;
  size_t room_ = 0;
};

/// Computes the shares of a block's beams under a model by the ray model with outliers:
///   f(z) = (1 − ε_h − ε_m) Σ_k w_k N(z; t_k, σ_k²) + ε_h / R
///   P(miss) = (1 − ε_h − ε_m) ∏_k (1 − p_k) + ε_m,   w_k = p_k ∏_{j<k} (1 − p_j)
/// z is the beam's range, R is `max_range_m`, and k counts the elements that the beam meets in
/// order of range. Shares are under `soft`: r_k ∝ w_k N(z; t_k, σ_k²) is the probability that
/// element k returned the beam, and Σ_{j>k} r_j that it went through element k; for a miss that is
/// the probability that it met nothing. The likelihoods of the totals are under
/// `trace::kReportedOutliers`, as those of the score are. The statistics of the elements are added
/// to `sums` unless it is null.
PassTotals find_shares(const ModelForm& model, const BeamBlock& block,
                       const trace::OutlierShares& soft, double max_range_m, BlockShares& shares,
                       ElementSums* sums);

/// Makes one pass over a share of the training beams of a log, in a world of one model. `soft` has
/// the outlier shares under which credit is given to elements. `progress(done, total)` may be
/// empty.
PassSums pass_over_training(const trace::World& world, const ListedBeams& beams,
                            credit::BeamShare share, const trace::OutlierShares& soft,
                            const std::function<void(size_t, size_t)>& progress = {});

/// Returns the result of a pass over all of a share. Its sums count each beam `share.weight()`
/// times, so that their means are those of all beams.
Expectation expectation_of(PassSums sums, credit::BeamShare share);

/// Returns `expectation_of` the sums of `pass_over_training`.
Expectation expect(const trace::World& world, const ListedBeams& beams, credit::BeamShare share,
                   const trace::OutlierShares& soft,
                   const std::function<void(size_t, size_t)>& progress = {});

/// Makes a pass over the held-out beams, to which a model was not fitted, and computes its sums.
ElementSums held_out_sums(const trace::World& world, const ListedBeams& beams,
                          const trace::OutlierShares& soft);

/// Computes the mean of −log f of the validation beams of a log (`ListedBeams::validation`) in a
/// world of one model, nats, as in `metrics::score`.
double validation_nll(const trace::World& world, const ListedBeams& beams);

}  // namespace underbrush::likelihood
