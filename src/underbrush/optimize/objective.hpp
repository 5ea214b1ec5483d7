/// \file
/// What is minimised.
#pragma once
#include "underbrush/fit/fit.hpp"
#include "underbrush/metrics/score.hpp"
#include "underbrush/optimize/search.hpp"
#include "underbrush/optimize/slice.hpp"

namespace underbrush::optimize {

/// Names of the objectives: `packet_f1`, mean packet error + 2 (1 − F1), [tallavajhula18] §V;
/// `nll`, the negative log-likelihood a beam.
std::vector<std::string> objectives();

/// The objective of scores of beams with ranges up to `max_range_m`. Where nothing is returned by
/// both, the packet error counts as `max_range_m` and F1 as 0. Throws `std::invalid_argument` for
/// an unknown name, and for `nll` without one.
double objective_of(const std::string& name, const metrics::Summary& scores, double max_range_m);

/// Answers the beams from the world and scores the answers; likelihood and CRPS only for `nll`,
/// which needs them.
Outcome outcome_of(const std::string& objective, const trace::World& world, const BeamLog& beams,
                   uint64_t seed);

/// Fits one part of the slice and scores the other.
Outcome fit_outcome(const std::string& objective, const Slice& slice,
                    const fit::FitOptions& options);

}  // namespace underbrush::optimize
