/// The options of `fit`, for every verb that fits.
#pragma once
#include <CLI/CLI.hpp>

#include "underbrush/fit/fit.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::app {

/// The footprint of a sensor's beam.
fit::Footprint footprint_of(const sensor::Sensor& sensor);

/// Adds them; the values stand in `fit`, which must outlive the parsing.
void add_fit_options(CLI::App& app, fit::FitOptions& fit);

}  // namespace underbrush::app
