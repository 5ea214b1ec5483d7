/// \file
/// The parameters of a fit that can be tuned.
#pragma once
#include "underbrush/fit/parameters.hpp"
#include "underbrush/optimize/parameter.hpp"

namespace underbrush::optimize {

/// A row of the table of fit parameters with its tuning range.
struct FitParameter : Parameter {
  bool usual = true;  ///< Tuned unless names are given.
  const fit::Parameter* of = nullptr;
};

/// The parameters with a tuning range that the fitter of `options` has (of `likelihood`: its own
/// and those of its start). The usual ones are clusters per point, τ and the largest residual,
/// which [tallavajhula18] tuned, the other parameters of the clustering, which it wished for, and
/// the prior of p.
std::vector<FitParameter> fit_parameters(const fit::FitOptions& options);

/// The parameters with the given names; the usual ones where there is none. Throws as `chosen`.
std::vector<FitParameter> chosen_fit_parameters(const fit::FitOptions& options,
                                                std::span<const std::string> names);

}  // namespace underbrush::optimize
