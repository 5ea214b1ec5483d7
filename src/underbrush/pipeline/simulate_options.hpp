/// \file
/// The options of the verb `simulate`, and their table.
#pragma once
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "underbrush/core/option.hpp"
#include "underbrush/regions/open_regions.hpp"
#include "underbrush/simulate/echoes.hpp"

namespace underbrush::pipeline {

/// The options of the instrument: of `simulate` with `super_sample`.
struct InstrumentOptions {
  std::string super_sample;  ///< "N", "NxM" or "sensor"; "" means thin rays without light.
  bool all_sub_rays = false;
  std::string returns;                ///< "strongest", "first", "last" or a number; "" = sensor's.
  std::string materials;              ///< A table of materials (YAML); "" = the built-in one.
  std::vector<std::string> material;  ///< Each is CLASS=MATERIAL.
  /// Visibility (m; 0 = clear air), rain (mm/h), and share of the sunlight that arrives.
  double visibility_m = 0, rain_mm_per_h = 0, sun = 0;
};

/// The options of `simulate`. Their words are those of the command line.
struct SimulateOptions {
  uint64_t seed = 1;
  std::string actors;           ///< A folder of actors, or a list of edits of one; "" = none.
  double tau = 0, grain_m = 0;  ///< 0 = those of the models.
  std::string matter = "once";  ///< "once", "still" or "anew".
  double sway_s = 0;            ///< s; option `wind`.
  std::string draw = "on_ray", beam = "thin", intensity = "mean";
  double max_range_m = 0;  ///< m; 0 = that of the beams.
  double range_noise_m = 0;
  bool element_ids = false;
  bool support = false;  ///< Whether to add the column `simulate::kSupportColumn`.
  /// "FIRST:END": only these beams, numbered from 0, are answered, as they are among all; "" = all.
  std::string beams;
  std::string memory = regions::kMemory;  ///< For a world of regions (`regions::OpenRegions`).
  bool keyframes = true;  ///< Whether keyframes may answer (`Simulation::recognise`).
  InstrumentOptions instrument;
  /// The beams whose waveforms `on_waveforms` receives, in the order of the beams; none if it is
  /// empty. With `all_waveforms` the count does not matter.
  simulate::WaveformChoice waveform{1, 100};
  bool all_waveforms = false;
  std::function<void(std::vector<simulate::BeamWaveform>)> on_waveforms{};

  /// Throws `std::invalid_argument` for values out of range and for options without effect.
  void check() const;
};

/// The beams [first, end) that `SimulateOptions::beams` names.
struct BeamRange {
  size_t first = 0, end = std::numeric_limits<size_t>::max();
};
/// Throws `std::invalid_argument` for a text that is not FIRST:END with FIRST < END.
BeamRange beam_range(const std::string& text);

/// All options of `simulate` that take a number or a word. Inputs, outputs, the seed and movers are
/// not in the table.
std::span<const Option<SimulateOptions>> simulate_options();
/// Groups of the table without effect where beams are fired one by one and keep no waveform.
inline constexpr std::string_view kPartsGroup = "Parts of a log", kWaveformsGroup = "Waveforms";

}  // namespace underbrush::pipeline
