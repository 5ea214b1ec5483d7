/// \file
/// The parameters of a fit that can be tuned.
#pragma once
#include <functional>

#include "underbrush/fit/fit.hpp"
#include "underbrush/optimize/parameter.hpp"

namespace underbrush::optimize {

/// A parameter of `fit::FitOptions`, named as the option of `underbrush fit`.
struct FitParameter : Parameter {
  bool usual = true;  ///< Tuned unless names are given.
  std::function<double(const fit::FitOptions&)> get;
  std::function<void(fit::FitOptions&, double)> set;
};

/// Those that the fitter of `options` has (of `likelihood`: those of its start, and its own).
/// The usual ones: clusters per point, τ and the largest residual, which [tallavajhula18] tuned,
/// the other parameters of the clustering, which it wished for, and the prior of p.
std::vector<FitParameter> fit_parameters(const fit::FitOptions& options);

/// Those with the given names; the usual ones where there is none. Throws as `chosen`.
std::vector<FitParameter> chosen_fit_parameters(const fit::FitOptions& options,
                                                std::span<const std::string> names);

}  // namespace underbrush::optimize
