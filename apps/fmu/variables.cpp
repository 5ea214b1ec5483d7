#include "variables.hpp"

namespace underbrush::fmu {
namespace {

constexpr Variable kVariables[] = {
    {kSensorViewIn, "OSMPSensorViewIn", Type::kBinary, Role::kInput, "SensorView",
     "What the environment simulator sees."},
    {kSensorDataOut, "OSMPSensorDataOut", Type::kBinary, Role::kOutput, "SensorData",
     "What the sensor reports."},
    {kSensorDataIn, "OSMPSensorDataIn", Type::kBinary, Role::kInput, "SensorData",
     "The output of a model before this one, which goes on with it."},
    {kSensorViewInConfigRequest, "OSMPSensorViewInConfigRequest", Type::kBinary,
     Role::kCalculatedParameter, "SensorViewConfiguration",
     "The rays that the environment simulator is asked for."},
    {kSensorViewInConfig, "OSMPSensorViewInConfig", Type::kBinary, Role::kParameter,
     "SensorViewConfiguration", "What the environment simulator gives; it mounts the sensor."},
    {kGroundTruthInit, "OSMPGroundTruthInit", Type::kBinary, Role::kParameter, "GroundTruth",
     "Static parts of the ground truth."},
    {kCount, "count", Type::kInteger, Role::kOutput, "0", "Number of objects in the output."},
    {kSeed, "seed", Type::kInteger, Role::kParameter, "1", "Seed of all random numbers."},
    {kThreads, "threads", Type::kInteger, Role::kParameter, "1",
     "Number of threads; 0 is one for each core. The results do not depend on it."},
    {kMaxEchoes, "max_echoes", Type::kInteger, Role::kParameter, "0",
     "Most echoes of a beam; 0 is as many as the sensor reports."},
    {kValid, "valid", Type::kBoolean, Role::kOutput, "false",
     "Whether the output describes the input of this step or of the last cycle."},
    {kCopySensorView, "copy_sensor_view", Type::kBoolean, Role::kParameter, "true",
     "Whether the output holds the SensorView that it was made from."},
    {kThresholdSnr, "threshold_snr", Type::kReal, Role::kParameter, "0",
     "Least signal-to-noise ratio of an echo; 0 is the sensor's."},
    {kExistenceThreshold, "existence_threshold", Type::kReal, Role::kParameter, "0",
     "Existence probability from which on an object is listed; 0 is the chain's."},
    {kLatencyMs, "latency_ms", Type::kReal, Role::kParameter, "0",
     "Time from a measurement to its list of objects, ms; 0 is the chain's."},
    {kCycle, "cycle_s", Type::kReal, Role::kParameter, "0",
     "Time between measurements, s; 0 is every new SensorView."},
    {kProfile, "profile", Type::kString, Role::kParameter, "",
     "The sensor: a name of the catalogue or a file; empty is the chain's."},
    {kInputMode, "input_mode", Type::kString, Role::kParameter, "ground_truth",
     "reflections: the SensorView holds what the rays met; ground_truth: the model traces them."},
    {kChain, "chain", Type::kString, Role::kParameter, "chain.yaml",
     "The strategies: a file of the archive's resources, or a path."},
    {kStrategies, "strategies", Type::kString, Role::kParameter, "",
     "Names of the chain's strategies to run, separated by commas; empty is all."},
    {kTracking, "tracking", Type::kString, Role::kParameter, "",
     "model: tracking knows the ground truth; real: it does not; empty is the chain's."},
    {kWorld, "world", Type::kString, Role::kParameter, "",
     "The folder of a model or scene that rays meet; empty is flat ground."},
    {kTraceOutputPath, "trace_output_path", Type::kString, Role::kParameter, "",
     "A file for all output messages (.osi); empty is none."},
};

}  // namespace

std::span<const Variable> variables() { return kVariables; }

const Variable* find(uint32_t reference) {
  for (const Variable& v : kVariables) {
    const uint32_t parts = v.type == Type::kBinary ? 3 : 1;
    if (reference >= v.reference && reference < v.reference + parts) return &v;
  }
  return nullptr;
}

}  // namespace underbrush::fmu
