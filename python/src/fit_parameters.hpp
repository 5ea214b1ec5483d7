/// \file
/// The parameters of a fit as Python gives them.
#pragma once
#include <nanobind/nanobind.h>

#include "underbrush/fit/parameters.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::python {

/// Sets the parameters by name, with `_` in place of `-`. Throws a Python `TypeError` for an
/// unknown name or a value of the wrong type, and `std::invalid_argument` for a value that is not a
/// choice. A sensor, unless null, gives the footprint that is removed from ellipsoids.
void set_fit_options(fit::FitOptions& options, const nanobind::dict& parameters, uint64_t seed,
                     const sensor::Sensor* sensor);

}  // namespace underbrush::python
