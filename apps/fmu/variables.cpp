#include "variables.hpp"

#include <algorithm>
#include <vector>

#include "underbrush/core/seed.hpp"
#include "underbrush/osi/osi_options.hpp"
#include "underbrush/perception/perceive_options.hpp"

namespace underbrush::fmu {
namespace {

// The variables that only the FMU has.
const Variable kOwn[] = {
    {kSensorViewIn, "OSMPSensorViewIn", Type::kBinary, Role::kInput, "SensorView",
     "The SensorView of the environment simulator."},
    {kSensorDataOut, "OSMPSensorDataOut", Type::kBinary, Role::kOutput, "SensorData",
     "The SensorData of the sensor model."},
    {kSensorDataIn, "OSMPSensorDataIn", Type::kBinary, Role::kInput, "SensorData",
     "The output of a preceding model, which this one continues."},
    {kSensorViewInConfigRequest, "OSMPSensorViewInConfigRequest", Type::kBinary,
     Role::kCalculatedParameter, "SensorViewConfiguration", "The rays that the FMU requests."},
    {kSensorViewInConfig, "OSMPSensorViewInConfig", Type::kBinary, Role::kParameter,
     "SensorViewConfiguration",
     "The rays that the environment simulator provides, with the mounting position of the sensor."},
    {kGroundTruthInit, "OSMPGroundTruthInit", Type::kBinary, Role::kParameter, "GroundTruth",
     "Static parts of the ground truth."},
    {kCount, "count", Type::kInteger, Role::kOutput, "0", "Number of objects in the output."},
    {kSeed, "seed", Type::kInteger, Role::kParameter, "1", kSeedHelp + std::string("."), 0,
     INT32_MAX},
    {kThreads, "threads", Type::kInteger, Role::kParameter, "1",
     "Number of threads; 0 is one for each core. The results do not depend on it.", 0, 1024},
    {kMaxEchoes, "max_echoes", Type::kInteger, Role::kParameter, "0",
     "Most echoes of a beam; 0 is as many as the sensor reports.", 0, 1000},
    {kValid, "valid", Type::kBoolean, Role::kOutput, "false",
     "Whether the output describes the input of this step or of the last cycle."},
    {kCopySensorView, "copy_sensor_view", Type::kBoolean, Role::kParameter, "true",
     "Whether the output holds the SensorView that it was made from."},
    {kThresholdSnr, "threshold_snr", Type::kReal, Role::kParameter, "0",
     "Least signal-to-noise ratio of an echo; 0 is the sensor's.", 0, 1e6},
    {kCycle, "cycle_s", Type::kReal, Role::kParameter, "0",
     "Time between measurements, s; 0 is every new SensorView.", 0, 1e6},
    {kInputMode, "input_mode", Type::kString, Role::kParameter, "ground_truth",
     "reflections: the SensorView holds what the rays met; ground_truth: the model traces them."},
    {kStrategies, "strategies", Type::kString, Role::kParameter, "",
     "Names of the chain's strategies to run, separated by commas; empty is all."},
    {kTraceOutputPath, "trace_output_path", Type::kString, Role::kParameter, "",
     "A file for all output messages (.osi); empty is none."},
};

Type type_of(std::string_view of_option) {
  if (of_option == "float") return Type::kReal;
  return of_option == "int" ? Type::kInteger : Type::kString;
}

// A parameter that is the option `option` of a verb. `otherwise` is the meaning of the start value.
template <class T>
Variable parameter(uint32_t reference, std::string_view name, std::span<const Option<T>> table,
                   std::string_view option, std::string_view start, std::string_view otherwise) {
  const auto row = std::find_if(table.begin(), table.end(),
                                [&](const Option<T>& o) { return o.name == option; });
  std::string meaning(row->help);
  if (!row->unit.empty()) meaning += ", " + std::string(row->unit);
  for (const std::string_view choice : row->choices) {
    meaning += (choice == row->choices.front() ? ": " : " or ") + std::string(choice);
  }
  meaning += "; " + std::string(otherwise) + ".";
  Variable v{reference, name, type_of(underbrush::type_of(*row)), Role::kParameter, start, meaning};
  if (v.type != Type::kString) v.least = 0, v.most = row->most;  // 0 is the start value.
  return v;
}

std::vector<Variable> all_variables() {
  const auto osi = osi::osi_options();
  const auto perceive = perception::perceive_options();
  std::vector<Variable> all(std::begin(kOwn), std::end(kOwn));
  all.insert(all.end(),
             {parameter(kExistenceThreshold, "existence_threshold", perceive, "threshold", "0",
                        "0 is the chain's"),
              parameter(kLatencyMs, "latency_ms", perceive, "latency-ms", "0", "0 is the chain's"),
              parameter(kTracking, "tracking", perceive, "pipeline", "", "empty is the chain's"),
              parameter(kProfile, "profile", osi, "sensor", "", "empty is the chain's"),
              parameter(kChain, "chain", osi, "chain", "chain.yaml",
                        "a file of the archive's resources, or a path"),
              parameter(kWorld, "world", osi, "world", "", "empty is flat ground")});
  std::sort(all.begin(), all.end(),
            [](const Variable& a, const Variable& b) { return a.reference < b.reference; });
  return all;
}

}  // namespace

std::span<const Variable> variables() {
  static const std::vector<Variable> kAll = all_variables();
  return kAll;
}

const Variable* find(uint32_t reference) {
  for (const Variable& v : variables()) {
    const uint32_t parts = v.type == Type::kBinary ? 3 : 1;
    if (reference >= v.reference && reference < v.reference + parts) return &v;
  }
  return nullptr;
}

}  // namespace underbrush::fmu
