/// \file
/// Responsibilities: how much of a beam's outcome each element explains under the ray model.
#pragma once
#include <span>
#include <vector>

#include "underbrush/trace/ray_likelihood.hpp"

namespace underbrush::fit {

/// One beam shared out over the m elements that it meets in order of range.
struct Responsibilities {
  /// r_k: probability that element k returned it. r_k ∝ w_k N(z; t_k, σ_k²), 0 for a miss.
  std::vector<double> hit;
  /// Probability that it went through element k: Σ_{j>k} r_j, and for a miss that it met nothing.
  std::vector<double> pass;
  double unexplained = 0;  ///< 1 − Σ r_k, for a miss 1 − the probability that it met nothing.
  double log_likelihood = 0;
  trace::RangeMixture mixture;  ///< Of the elements, its weights adding up to the explained share.
};

/// Replaces `out` with the responsibilities for a beam of range `range_m` (m; kMiss without a
/// return) under
///   f(z) = (1 − ε_h − ε_m) Σ_k w_k N(z; t_k, σ_k²) + ε_h / R
///   P(miss) = (1 − ε_h − ε_m) ∏_k (1 − p_k) + ε_m,   w_k = p_k ∏_{j<k} (1 − p_j)
/// with ε of `outliers` and R = `max_range_m`.
void find_responsibilities(std::span<const trace::Intersection> met, double range_m,
                           const trace::OutlierShares& outliers, double max_range_m,
                           Responsibilities& out);

}  // namespace underbrush::fit
