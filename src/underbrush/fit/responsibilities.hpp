/// \file
/// This file computes responsibilities: the share of a beam's outcome that each element explains
/// under the ray model.
#pragma once
#include <span>
#include <vector>

#include "underbrush/trace/ray_likelihood.hpp"

namespace underbrush::fit {

/// A beam shared out over the m elements that it meets, in order of range.
struct Responsibilities {
  /// r_k ∝ w_k N(z; t_k, σ_k²): the probability that element k returned the beam. It is 0 for a
  /// miss.
  std::vector<double> hit;
  /// The probability that the beam went through element k: Σ_{j>k} r_j for a return, and for a miss
  /// the probability that it met nothing.
  std::vector<double> pass;
  /// The part of the outcome that no element explains: 1 − Σ r_k for a return, 1 − `pass` for a
  /// miss.
  double unexplained = 0;
  double log_likelihood = 0;  ///< The log of f(z) or of P(miss) below.
  trace::RangeMixture
      mixture;  ///< Mixture of the elements; its weights sum to the explained share.
};

/// Computes the responsibilities for one beam under the ray model with outliers:
///   f(z) = (1 − ε_h − ε_m) Σ_k w_k N(z; t_k, σ_k²) + ε_h / R
///   P(miss) = (1 − ε_h − ε_m) ∏_k (1 − p_k) + ε_m,   w_k = p_k ∏_{j<k} (1 − p_j)
/// `met` lists the elements in order of range, z is `range_m` (m; kMiss without a return), ε_h and
/// ε_m are those of `outliers`, and R is `max_range_m`. The result replaces `out`, whose memory
/// is used again.
void find_responsibilities(std::span<const trace::Intersection> met, double range_m,
                           const trace::OutlierShares& outliers, double max_range_m,
                           Responsibilities& out);

}  // namespace underbrush::fit
