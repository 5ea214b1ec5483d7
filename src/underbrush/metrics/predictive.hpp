/// \file
/// What the ray model says of one beam before it is fired: a distribution over ranges and the miss.
#pragma once
#include <span>
#include <vector>

#include "underbrush/trace/element_math.hpp"

namespace underbrush {
/// Scores of a simulation against reality.
namespace metrics {

/// A mixture Σ w_k N(t_k, σ_k²) of ranges, and a miss with the rest of the weight:
/// w_k = p_k ∏_{j<k} (1 − p_j) over the elements met in order, P(miss) = ∏ (1 − p_k).
struct Predictive {
  /// One Gaussian: w_k, t_k, σ_k.
  struct Component {
    double weight, t_m, sigma_m;
  };
  std::vector<Component> components;
  double miss = 1;
};

/// Share of outliers mixed in before a logarithm is taken, half of them misses and half of them
/// hits uniform in [0, max range]: an unexplained beam costs a finite amount, the same for every
/// model.
inline constexpr double kOutlierShare = 0.01;

/// The distribution from the elements met (in order of range). Stops where less than `negligible`
/// of the weight is left, which then counts as the miss.
void predict(std::span<const trace::Met> met, double negligible, Predictive& out);

/// −log of the probability density (1/m) of a hit at `range_m`, or of the probability of a miss
/// (`range_m` = kMiss), outliers mixed in.
double negative_log_likelihood(const Predictive& p, double range_m, double max_range_m);

/// Continuous ranked probability score (m) of the range, a miss counting as a return at the maximum
/// range: E|X − z| − ½ E|X − X'|, in closed form for the mixture (Grimit et al. 2006). Lower is
/// better; for a point forecast it is the absolute error.
double crps(const Predictive& p, double range_m, double max_range_m);

}  // namespace metrics
}  // namespace underbrush
