/// \file
/// The instrument of `simulate`: its options on the command line, and the objects made from them.
#pragma once
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/verb.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/sensor/sensor.hpp"
#include "underbrush/simulate/echoes.hpp"

namespace underbrush::app {

/// The options of the instrument.
struct InstrumentArguments {
  std::string super_sample;  ///< "" means none: thin rays without light.
  bool all_sub_rays = false;
  std::string footprint = "excess";
  std::string returns, materials;
  std::vector<std::string> material;  ///< Each is CLASS=MATERIAL.
  /// Visibility (m; 0 = clear air), rain (mm/h), and share of the sunlight that arrives.
  double visibility_m = 0, rain_mm_per_h = 0, sun = 0;
  std::vector<std::string> waveforms;
  simulate::WaveformChoice waveform{1, 100};

  /// Throws `std::invalid_argument` where an option has no effect without `--super-sample`.
  void check() const;
};

/// Adds the options of the instrument to a verb.
void add_instrument_options(Verb& verb, InstrumentArguments& a);

/// Returns the sensor's instrument: sub-rays, receiver in this air and light, and return mode.
/// `recorder` is what `recorder_of` gives: the models answer as for its beam, so that sub-rays are
/// spread by what the sensor's is wider (`sensor::wider_by`) unless the whole footprint is asked
/// for, and the same sensor has the range noise and the farthest range of its log.
simulate::Instrument instrument_of(const InstrumentArguments& a, sensor::Sensor sensor,
                                   const std::optional<sensor::Sensor>& recorder);

/// Returns the sensor that recorded the logs to which the models were fitted, with the
/// range noise and the farthest range that they showed; of several that with the narrowest beam.
/// There is none where a model with ellipsoids (or any, if none has) does not know its own, or has
/// shares of the light.
std::optional<sensor::Sensor> recorder_of(std::span<const elements::Model> models);

/// Returns the materials with those that the scene brings along and the user's changes. A table
/// that the user names goes before the scene's own materials.
radiometry::Materials materials_of(const InstrumentArguments& a,
                                   const simulate::InstanceKinds& kinds = {});

/// Whether a file for waveforms is binary, and so has those of all beams.
bool is_waveform_file(const std::string& file);
/// Writes the waveforms to every table and plot asked for (.csv or .svg). `sensor` gives the title
/// of a plot.
void write_waveforms(const InstrumentArguments& a, const sensor::Sensor& sensor,
                     const std::vector<simulate::BeamWaveform>& waveforms);

}  // namespace underbrush::app
