/// \file
/// The options of `fit` that all verbs with a fit share.
#pragma once
#include <vector>

#include "cli/verb.hpp"
#include "underbrush/fit/fit.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::app {

/// Whether `--help` shows what most users need, or leaves all to `--help-all`.
enum FitHelp { kUsualShown, kAllRare };

/// Adds an option for each row of the table of fit parameters (`fit::parameters`), and `--sensor`.
std::vector<const CLI::Option*> add_fit_options(Verb& verb, fit::FitOptions& fit,
                                          FitHelp help = kUsualShown);

/// The footprint of a sensor's beam, as a fit takes it.
fit::Footprint footprint_of(const sensor::Sensor& sensor);

}  // namespace underbrush::app
