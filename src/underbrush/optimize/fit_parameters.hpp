/// \file
/// This file lists the parameters of a fit that can be tuned.
#pragma once
#include "underbrush/fit/parameters.hpp"
#include "underbrush/optimize/parameter.hpp"

namespace underbrush::optimize {

/// A row of the table of fit parameters with its tuning range.
struct FitParameter : Parameter {
  bool usual = true;                   ///< Whether it is tuned if the user names no parameters.
  const fit::Parameter* of = nullptr;  ///< The row of the table.
};

/// Lists the parameters with a tuning range that the fitter of `options` has; `likelihood` has its
/// own and those of its start. The usual ones are clusters per point, τ and the largest residual,
/// which [tallavajhula18] tuned, the other parameters of the clustering, which it proposed to tune,
/// and the prior of p.
std::vector<FitParameter> fit_parameters(const fit::FitOptions& options);

/// Selects parameters by name, or the usual ones if no name is given. Throws as `chosen` does.
std::vector<FitParameter> chosen_fit_parameters(const fit::FitOptions& options,
                                                std::span<const std::string> names);

}  // namespace underbrush::optimize
