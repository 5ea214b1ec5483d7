/// \file
/// The likelihood of a beam's outcome under the ray model: a mixture of ranges, and outliers.
#pragma once
#include <span>
#include <vector>

#include "underbrush/trace/element_math.hpp"

namespace underbrush::trace {

/// Shares of the beams that no element explains: returns anywhere in [0, R], where R is the largest
/// range, and returns that were lost.
struct OutlierShares {
  double hit = 0.005, miss = 0.005;

  /// The share that the elements explain.
  double explained() const { return 1 - hit - miss; }
  /// What outliers add to the density (1/m) of a return, or to the probability of a miss.
  double likelihood(bool is_hit, double max_range_m) const {
    return is_hit ? hit / max_range_m : miss;
  }
};

/// The shares of every likelihood that is reported (scores, held-out beams of a fit): one beam in a
/// hundred, so that an unexplained beam costs a finite amount, the same for every model.
inline constexpr OutlierShares kReportedOutliers{0.005, 0.005};

/// A mixture Σ w_k N(t_k, σ_k²) of ranges, and a miss with the rest of the weight.
struct RangeMixture {
  /// One Gaussian: w_k, t_k, σ_k.
  struct Component {
    double weight, t_m, sigma_m;
    /// w N(z; t, σ²) in 1/m; 0 beyond 12 σ and where σ is 0.
    double density(double range_m) const;
  };
  std::vector<Component> components;
  double miss = 1;

  /// Σ w_k N(z; t_k, σ_k²) in 1/m of a return at `range_m`, or the weight of the miss (`kMiss`).
  double likelihood(double range_m) const;
};

/// Replaces `out` with the mixture of the elements that a beam meets, in order of range:
/// w_k = w p_k ∏_{j<k} (1 − p_j) and w ∏ (1 − p_k) for the miss, w = `weight`. It stops where less
/// than `negligible` of the weight is left, which then counts as the miss.
void mix_ranges(std::span<const Intersection> met, double weight, double negligible,
                RangeMixture& out);

}  // namespace underbrush::trace
