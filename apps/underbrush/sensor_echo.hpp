/// `underbrush sensors`: its arguments, and what a sensor makes of targets.
#pragma once
#include <string>
#include <vector>

#include "cli/verb.hpp"

namespace underbrush::app {

struct SensorsArguments {
  std::string action, name, plot, csv;
  std::vector<std::string> targets;  ///< RANGE[:MATERIAL[:SHARE]].
  double visibility_m = 0, rain_mm_per_h = 0;
};

/// `sensors echo`: one beam, its targets, waveform and echoes.
void echo_of_sensor(const Verb& verb, const SensorsArguments& a);

}  // namespace underbrush::app
