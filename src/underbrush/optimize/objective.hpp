/// \file
/// This file has the objectives that a search minimises.
#pragma once
#include <string>
#include <vector>

#include "underbrush/metrics/score.hpp"

namespace underbrush::optimize {

/// The names of the objectives: `packet_f1` is the mean packet error + 2 (1 − F1) of
/// [tallavajhula18] §V, and `nll` the negative log-likelihood per beam.
std::vector<std::string> objectives();

/// Computes the objective from the scores of beams with ranges up to `max_range_m`. Where no beam
/// is a true hit, the packet error counts as `max_range_m` and F1 as 0. Throws
/// `std::invalid_argument` for an unknown name, and for `nll` without a likelihood.
double objective_of(const std::string& name, const metrics::Summary& scores, double max_range_m);

}  // namespace underbrush::optimize
