/// \file
/// This file has the predictive distribution of a beam under the ray model, over ranges and the
/// miss.
#pragma once
#include <span>
#include <vector>

#include "underbrush/trace/element_math.hpp"

namespace underbrush {
/// Scores that compare simulations with reality.
namespace metrics {

/// A mixture Σ w_k N(t_k, σ_k²) of ranges, and a miss with the remaining weight. Over the elements
/// met in order, w_k = p_k ∏_{j<k} (1 − p_j) and P(miss) = ∏ (1 − p_k).
struct Predictive {
  /// A Gaussian of the mixture: w_k, t_k, σ_k.
  struct Component {
    double weight, t_m, sigma_m;
  };
  std::vector<Component> components;
  double miss = 1;
};

/// The share of outliers that is mixed in before a logarithm is taken. Half of them are misses, and
/// half are hits uniform in [0, maximum range]. An unexplained beam then costs a finite amount,
/// which is the same for every model.
inline constexpr double kOutlierShare = 0.01;

/// Computes the distribution from the elements met, in order of range. It stops where less than
/// `negligible` of the weight is left, which then counts as a miss.
void predict(std::span<const trace::Met> met, double negligible, Predictive& out);

/// Computes −log of the probability density (1/m) of a return at `range_m`, or of the probability
/// of a miss (`range_m` = kMiss), with outliers mixed in.
double negative_log_likelihood(const Predictive& p, double range_m, double max_range_m);

/// Computes the continuous ranked probability score of the range, m, in which a miss counts as a
/// return at the maximum range: E|X − z| − ½ E|X − X'|, in closed form for the mixture (Grimit et
/// al. 2006). Lower is better; for a point forecast it is the absolute error.
double crps(const Predictive& p, double range_m, double max_range_m);

}  // namespace metrics
}  // namespace underbrush
