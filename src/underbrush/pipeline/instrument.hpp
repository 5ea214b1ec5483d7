/// \file
/// This file makes the instrument and the materials of a simulation from its options.
#pragma once
#include <optional>

#include "underbrush/pipeline/simulate_options.hpp"
#include "underbrush/sensor/sensor.hpp"
#include "underbrush/simulate/reflection.hpp"

namespace underbrush::pipeline {

/// Returns the sensor's instrument: sub-rays, receiver in this air and light, and return mode. The
/// models of a world answer as for the beam of `recorder` (`TracedWorld::recorder`), which is the
/// instrument's `fitted_beam`. The step of its encoder is in the models, so that of the sensor
/// counts only where it is greater. The same sensor has the range noise and the farthest range of
/// its log. Throws `std::invalid_argument` for words that are none.
simulate::Instrument instrument_of(const InstrumentOptions& options, sensor::Sensor sensor,
                                   const std::optional<sensor::Sensor>& recorder);

/// Returns the materials with those that the scene brings along and the user's changes. A table
/// that the user names goes before the scene's own materials. Throws `std::invalid_argument` for an
/// unknown class or material.
radiometry::Materials materials_of(const InstrumentOptions& options,
                                   const simulate::InstanceKinds& kinds = {});

/// Whether a sensor's instrument reports the intensities of the light that the models have learnt:
/// it is the sensor of their log, the air is clear, and no materials are asked for.
bool has_learnt_light(const InstrumentOptions& options, const sensor::Sensor& sensor,
                      const std::optional<sensor::Sensor>& recorder);

}  // namespace underbrush::pipeline
