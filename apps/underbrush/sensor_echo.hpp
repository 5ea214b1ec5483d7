/// The arguments of `underbrush sensors`, and its action `echo`.
#pragma once
#include <string>
#include <vector>

#include "cli/verb.hpp"

namespace underbrush::app {

/// Arguments of `underbrush sensors`.
struct SensorsArguments {
  std::string action, name, plot, csv;
  std::vector<std::string> targets;  ///< Each is RANGE[:MATERIAL[:SHARE]], range in m.
  /// Visibility (m; 0 = clear air) and rain (mm/h).
  double visibility_m = 0, rain_mm_per_h = 0;
};

/// Runs `sensors echo`: one beam with its targets, waveform and echoes.
void echo_of_sensor(const Verb& verb, const SensorsArguments& a);

}  // namespace underbrush::app
