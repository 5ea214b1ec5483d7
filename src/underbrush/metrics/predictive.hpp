/// \file
/// Scores of what the ray model predicts for one beam: a distribution over ranges and the miss.
#pragma once
#include "underbrush/trace/ray_likelihood.hpp"

namespace underbrush {
/// Scores of a simulation against reality.
namespace metrics {

/// −log of the probability density (1/m) of a hit at `range_m`, or of the probability of a miss
/// (`range_m` = kMiss), under `trace::kReportedOutliers`.
double negative_log_likelihood(const trace::RangeMixture& p, double range_m, double max_range_m);

/// Continuous ranked probability score (m) of the range, a miss counting as a return at the maximum
/// range: E|X − z| − ½ E|X − X'|, in closed form for the mixture (Grimit et al. 2006). Lower is
/// better; for a point forecast it is the absolute error.
double crps(const trace::RangeMixture& p, double range_m, double max_range_m);

}  // namespace metrics
}  // namespace underbrush
