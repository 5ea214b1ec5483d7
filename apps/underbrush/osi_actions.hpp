/// \file
/// What the verb `osi` does.
#pragma once
#include <string>
#include <vector>

#include "cli/verb.hpp"

namespace underbrush::app {

/// The options of the verb `osi`.
struct OsiArguments {
  std::string action, input, output, truth, chain, sensor, world;
  std::vector<std::string> strategies;  ///< Each is NAME[:KEY=VALUE,...].
  bool without_view = false;
  double white_intensity = 255, truth_elevation_deg = 0;
};

/// Tells what a trace holds.
void osi_info(const Verb& verb, const OsiArguments& a);
/// Writes the scans of a log as a SensorView trace with reflections.
void osi_record(const Verb& verb, const OsiArguments& a);
/// Runs a chain of strategies on a trace.
void osi_replay(const Verb& verb, const OsiArguments& a);
/// Converts a trace to a log or lists of objects, or lists to a trace.
void osi_convert(const Verb& verb, const OsiArguments& a);

}  // namespace underbrush::app
