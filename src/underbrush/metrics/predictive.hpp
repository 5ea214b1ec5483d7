/// \file
/// This file scores the predictive distribution of a beam under the ray model, which is over ranges
/// and the miss.
#pragma once
#include "underbrush/trace/ray_likelihood.hpp"

namespace underbrush {
/// Scores that compare simulations with reality.
namespace metrics {

/// Computes −log of the probability density (1/m) of a return at `range_m`, or of the probability
/// of a miss (`range_m` = kMiss), under the mixture with `trace::kReportedOutliers`.
double negative_log_likelihood(const trace::RangeMixture& p, double range_m, double max_range_m);

/// Computes the probability of a return under the mixture with `trace::kReportedOutliers`.
double return_probability(const trace::RangeMixture& p);

/// Computes the continuous ranked probability score of the range, m, in which a miss counts as a
/// return at the maximum range: E|X − z| − ½ E|X − X'|, in closed form for the mixture (Grimit et
/// al. 2006). Lower is better; for a point forecast it is the absolute error.
double crps(const trace::RangeMixture& p, double range_m, double max_range_m);

}  // namespace metrics
}  // namespace underbrush
