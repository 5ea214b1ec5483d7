/// \file
/// This file has the objectives that a search minimises.
#pragma once
#include "underbrush/fit/fit.hpp"
#include "underbrush/metrics/score.hpp"
#include "underbrush/optimize/search.hpp"
#include "underbrush/optimize/slice.hpp"

namespace underbrush::optimize {

/// The names of the objectives: `packet_f1` is the mean packet error + 2 (1 − F1) of
/// [tallavajhula18] §V, and `nll` the negative log-likelihood a beam.
std::vector<std::string> objectives();

/// Computes the objective from the scores of beams with ranges up to `max_range_m`. Where no beam
/// is a true hit, the packet error counts as `max_range_m` and F1 as 0. Throws
/// `std::invalid_argument` for an unknown name, and for `nll` without a likelihood.
double objective_of(const std::string& name, const metrics::Summary& scores, double max_range_m);

/// Answers the beams from the world and scores the answers. Likelihood and CRPS are computed only
/// for `nll`, which needs them.
Outcome outcome_of(const std::string& objective, const trace::World& world, const BeamLog& beams,
                   uint64_t seed);

/// Fits a model to one part of the slice and scores it on the other.
Outcome fit_outcome(const std::string& objective, const Slice& slice,
                    const fit::FitOptions& options);

}  // namespace underbrush::optimize
