/// \file
/// This file has a search without derivatives that can be interrupted and resumed.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "underbrush/optimize/parameter.hpp"

namespace underbrush::optimize {

/// The result of a set of values: the objective, which is finite and better if lower, and the
/// scores that it is made of.
struct Outcome {
  double objective = 0;
  std::map<std::string, double> score;
};

/// A set of values that was tried.
struct Evaluation {
  std::vector<double> value;  ///< The value of each parameter.
  Outcome outcome;
};

/// The options of `search`.
struct SearchOptions {
  /// An algorithm of NLopt: `cobyla` ([powell94]; linear models, used by [tallavajhula18]),
  /// `bobyqa` (quadratic models, for two parameters or more) or `sbplx` (simplex on subspaces).
  std::string algorithm = "cobyla";
  size_t budget = 60;  ///< Largest number of evaluations, those of the past included.
  double step = 0.2;   ///< The first step, as a share of each range.
};

/// The names of the algorithms.
std::vector<std::string> algorithms();

/// Searches for values with a low objective. It tries `start` (clamped into the ranges) and runs
/// the algorithm from there. When that has converged, it starts again from the best values with
/// half the step, down to a tenth of the first step, while there is budget. Values tried before are
/// not evaluated again.
///
/// The search is deterministic and can therefore be resumed: `past` has the evaluations of an
/// interrupted search, from which the same calls are answered. `after` is called after each new
/// evaluation with all evaluations so far. The result has all evaluations, at least one. Throws
/// `std::invalid_argument` where `past` belongs to another search and for options out of range.
/// Exceptions of `objective` and `after` pass through.
std::vector<Evaluation> search(std::span<const Parameter> parameters, std::span<const double> start,
                               const SearchOptions& options,
                               const std::function<Outcome(std::span<const double>)>& objective,
                               const std::vector<Evaluation>& past = {},
                               const std::function<void(std::span<const Evaluation>)>& after = {});

/// Finds the evaluation with the lowest objective, the first of equals.
size_t best_of(std::span<const Evaluation> evaluations);

}  // namespace underbrush::optimize
