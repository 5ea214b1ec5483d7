/// \file
/// The light that a sensor receives from one beam.
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "underbrush/radiometry/receiver.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::pipeline {

/// The waveform of a beam and the echoes in it.
struct SensorEcho {
  std::vector<std::pair<double, double>> waveform;  ///< Range (m) and signal.
  double cell_m = 0;                                ///< m; the step of the waveform.
  radiometry::Echoes echoes;
  std::vector<float> signal;  ///< The peak signal of each target's return.
  double extinction_per_m = 0;
};

/// Returns the echo of targets that the beam meets perpendicularly, each RANGE[:MATERIAL[:SHARE]]
/// (m; share of the beam, by default equal ones), in haze of this visibility (m; 0 = clear air) and
/// rain (mm/h). Throws `std::invalid_argument` for words of another form and unknown materials.
SensorEcho echo_of_targets(const sensor::Sensor& sensor, const std::vector<std::string>& targets,
                           double visibility_m, double rain_mm_per_h, uint64_t seed);

}  // namespace underbrush::pipeline
