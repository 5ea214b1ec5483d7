/// \file
/// Plots of a sensor's pattern and of the light that it receives, as SVG files.
#pragma once
#include <string>
#include <vector>

#include "report/svg_plot.hpp"
#include "underbrush/pipeline/sensor_echo.hpp"
#include "underbrush/pipeline/simulate_options.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::report {

/// Returns a scan in the sensor's frame, as azimuths and elevations in degrees, of at most `most`
/// beams.
SvgPlot::Points one_scan(const sensor::Sensor& sensor, size_t most);

/// Draws the pattern of a scan. A large scan is cut to the part around straight ahead, so that
/// single beams are visible.
void plot_pattern(const sensor::Sensor& sensor, SvgPlot::Points scan, const std::string& file);

/// Draws the signal of one beam, the threshold and the echoes.
void plot_echoes(const sensor::Sensor& sensor, const pipeline::SensorEcho& echo,
                 const std::string& file);

/// Draws one waveform above the other, each scaled to its own peak (but at least twice the
/// threshold).
void plot_waveforms(const std::string& file, const sensor::Sensor& sensor,
                    const std::vector<simulate::BeamWaveform>& waveforms);

}  // namespace underbrush::report
