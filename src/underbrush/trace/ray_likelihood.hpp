/// \file
/// This file has the likelihood of a beam's outcome under the ray model: a mixture of ranges, and
/// outliers.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "underbrush/trace/element_math.hpp"

namespace underbrush::trace {

/// Probabilities that no element explains a beam: `hit` (ε_h) of a return at a range spread evenly
/// over [0, maximum range], and `miss` (ε_m) of a return that was lost.
struct OutlierShares {
  double hit = 0.005, miss = 0.005;

  /// The probability that the elements explain a beam.
  double explained() const { return 1 - hit - miss; }
  /// The part of the outliers in the density (1/m) of a return, or in the probability of a miss.
  double likelihood(bool is_hit, double max_range_m) const {
    return is_hit ? hit / max_range_m : miss;
  }
};

/// The outliers of every likelihood that is reported, in scores and for the held-out beams of a
/// fit. One beam in a hundred is an outlier, half of them misses. An unexplained beam then costs a
/// finite amount, which is the same for every model.
inline constexpr OutlierShares kReportedOutliers{0.005, 0.005};

/// A mixture Σ w_k N(t_k, σ_k²) of ranges, and a miss with the remaining weight.
struct RangeMixture {
  /// A Gaussian of the mixture: w_k, t_k, σ_k.
  struct Component {
    double weight, t_m, sigma_m;
    /// The density w N(z; t, σ²) at z = `range_m`, 1/m; 0 beyond 12 σ and where σ is 0.
    double density(double range_m) const;
  };
  std::vector<Component> components;
  double miss = 1;

  /// The density Σ w_k N(z; t_k, σ_k²) of a return at z = `range_m`, 1/m, or the weight of the miss
  /// (`range_m` = kMiss).
  double likelihood(double range_m) const;
  /// The probability of a return.
  double returns() const;
  /// The median of the ranges of the returns, m, within half a millimetre; nothing where a miss is
  /// likelier than a return.
  std::optional<double> median() const;
  /// The number of the component that is likeliest at a range (m), or of the nearest one if none
  /// is likely at all. There must be one.
  size_t likeliest_at(double range_m) const;
};

/// Computes the mixture of the elements that a beam meets: w_k = w p_k ∏_{j<k} (1 − p_j), and
/// w ∏ (1 − p_k) for the miss, with w = `weight`. `met` is in order of range. It stops where less
/// than `negligible` of the weight is left, which then counts as the miss. The result replaces
/// `out`.
void mix_ranges(std::span<const Intersection> met, double weight, double negligible,
                RangeMixture& out);

}  // namespace underbrush::trace
