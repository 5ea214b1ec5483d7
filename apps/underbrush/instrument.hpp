/// \file
/// `simulate`'s instrument: its options on the command line, and what they make.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/elements/scene_file.hpp"
#include "underbrush/sensor/sensor.hpp"
#include "underbrush/simulate/echoes.hpp"
#include "cli/verb.hpp"

namespace underbrush::app {

/// What the user says of the instrument.
struct InstrumentArguments {
  std::string super_sample;  ///< "" = none: thin rays without light.
  std::string returns, materials;
  std::vector<std::string> material;  ///< CLASS=MATERIAL.
  double visibility_m = 0, rain_mm_per_h = 0, sun = 0;
  std::vector<std::string> waveforms;
  simulate::WaveformChoice waveform{1, 100};

  /// Throws `std::invalid_argument` where an option makes no sense without `--super-sample`.
  void check() const;
};

void add_instrument_options(Verb& verb, InstrumentArguments& a);

/// The sensor's instrument: sub-rays, receiver in this air and light, return mode.
simulate::Instrument instrument_of(const InstrumentArguments& a, const sensor::Sensor& sensor);

/// The materials, with the user's changes.
radiometry::Materials materials_of(const InstrumentArguments& a);

/// Class and material of each instance.
simulate::InstanceKinds kinds_of(const elements::Scene& scene, const elements::SceneInfo& info);

/// Writes the waveforms to every file asked for: .csv or .svg. `sensor` for the plot's title.
void write_waveforms(const InstrumentArguments& a, const sensor::Sensor& sensor,
                     const std::vector<simulate::BeamWaveform>& waveforms);

}  // namespace underbrush::app
