/// \file
/// This file makes the instrument and the materials of a simulation from its options.
#pragma once
#include <optional>

#include "underbrush/pipeline/simulate_options.hpp"
#include "underbrush/sensor/sensor.hpp"
#include "underbrush/simulate/reflection.hpp"

namespace underbrush::pipeline {

/// Returns the sensor's instrument: sub-rays, receiver in this air and light, and return mode. The
/// models of a world answer as for the beam of `recorder` (`TracedWorld::recorder`), so sub-rays
/// are spread over what the sensor's beam is wider (`sensor::wider_by`) unless the whole footprint
/// is asked for, and the same sensor has the range noise and the farthest range of its log. Throws
/// `std::invalid_argument` for words that are none.
simulate::Instrument instrument_of(const InstrumentOptions& options, sensor::Sensor sensor,
                                   const std::optional<sensor::Sensor>& recorder);

/// Returns the materials with those that the scene brings along and the user's changes. A table
/// that the user names goes before the scene's own materials. Throws `std::invalid_argument` for an
/// unknown class or material.
radiometry::Materials materials_of(const InstrumentOptions& options,
                                   const simulate::InstanceKinds& kinds = {});

}  // namespace underbrush::pipeline
