/// \file
/// The options of `fit` that all verbs with a fit share.
#pragma once
#include <vector>

#include "cli/verb.hpp"
#include "underbrush/fit/fit_options.hpp"

namespace underbrush::app {

/// Whether `--help` shows the options that most users need, or `--help-all` alone shows them.
enum FitHelp { kUsualShown, kAllRare };

/// Adds an option for each row of the table of fit parameters (`fit::parameters`), and `--sensor`.
/// Returns the options.
std::vector<const CLI::Option*> add_fit_options(Verb& verb, fit::FitOptions& fit,
                                                FitHelp help = kUsualShown);

}  // namespace underbrush::app
