/// \file
/// A search without derivatives that can be interrupted and taken up again.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "underbrush/optimize/parameter.hpp"

namespace underbrush::optimize {

/// What a set of values came to: the objective (finite, lower is better) and what it is made of.
struct Outcome {
  double objective = 0;
  std::map<std::string, double> score;
};

/// One set of values that was tried.
struct Evaluation {
  std::vector<double> value;  ///< One a parameter.
  Outcome outcome;
};

/// Options of `search`.
struct SearchOptions {
  /// `cobyla` ([powell94]: linear models; what the authors of [tallavajhula18] took), `bobyqa`
  /// (quadratic models, two parameters or more) or `sbplx` (simplex on subspaces), all of NLopt.
  std::string algorithm = "cobyla";
  size_t budget = 60;  ///< Most evaluations, those of the past included.
  double step = 0.2;   ///< The first step, as a share of each range.
};

/// Names of the algorithms.
std::vector<std::string> algorithms();

/// Tries `start` (clamped into the ranges), then searches from there for lower objectives; when the
/// algorithm has converged, begins anew at the best with half the step, down to a tenth of the
/// first, while there is budget. Values tried before are not tried again. Deterministic, so that a
/// search goes on where another ended: `past` are its evaluations, and the same calls are answered
/// from there. `after` is called after each new evaluation with all so far. Returns all, at least
/// one. Throws `std::invalid_argument` where `past` is not of this search, and for options out of
/// range; what `objective` or `after` throw passes through.
std::vector<Evaluation> search(std::span<const Parameter> parameters, std::span<const double> start,
                               const SearchOptions& options,
                               const std::function<Outcome(std::span<const double>)>& objective,
                               const std::vector<Evaluation>& past = {},
                               const std::function<void(std::span<const Evaluation>)>& after = {});

/// The evaluation of the least objective, the first of equals.
size_t best_of(std::span<const Evaluation> evaluations);

}  // namespace underbrush::optimize
