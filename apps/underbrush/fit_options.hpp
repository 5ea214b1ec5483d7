/// The options of `fit`, for every verb that fits.
#pragma once
#include <CLI/CLI.hpp>

#include "underbrush/fit/fit.hpp"

namespace underbrush::app {

/// Adds them; the values stand in `fit`, which must outlive the parsing.
void add_fit_options(CLI::App& app, fit::FitOptions& fit);

}  // namespace underbrush::app
