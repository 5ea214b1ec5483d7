#include "variables.hpp"

#include <array>
#include <cstdio>

#include "underbrush/core/rng.hpp"

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

std::string_view causality(Role role) {
  constexpr std::array<std::string_view, 4> kWords{"input", "output", "parameter",
                                                   "calculatedParameter"};
  return kWords[size_t(role)];
}

bool is_discrete(Role role) { return role == Role::kInput || role == Role::kOutput; }

// The attributes that all types share.
std::string scalar(std::string_view name, uint32_t reference, const Variable& v) {
  const char* initial = v.role == Role::kInput                 ? ""
                        : v.role == Role::kCalculatedParameter ? "calculated"
                                                               : "exact";
  std::string text = "    <ScalarVariable name=\"" + std::string(name) + "\" valueReference=\"" +
                     std::to_string(reference) + "\" causality=\"" +
                     std::string(causality(v.role)) + "\" variability=\"" +
                     (is_discrete(v.role) ? "discrete" : "fixed") + "\"";
  if (*initial) text += " initial=\"" + std::string(initial) + "\"";
  return text + " description=\"" + std::string(v.meaning) + "\">\n";
}

std::string binary(const Variable& v) {
  constexpr const char* kParts[] = {"base.lo", "base.hi", "size"};
  std::string text;
  for (uint32_t k = 0; k < 3; ++k) {
    text += scalar(std::string(v.name) + "." + kParts[k], v.reference + k, v);
    text += v.role == Role::kCalculatedParameter ? "      <Integer/>\n"
                                                 : "      <Integer start=\"0\"/>\n";
    text +=
        "      <Annotations>\n        <Tool name=\"net.pmsf.osmp\" "
        "xmlns:osmp=\"http://xsd.pmsf.net/OSISensorModelPackaging\">"
        "<osmp:osmp-binary-variable name=\"" +
        std::string(v.name) + "\" role=\"" + kParts[k] +
        "\" mime-type=\"application/x-open-simulation-interface; type=" + std::string(v.start) +
        "; version=3.8.0\"/></Tool>\n      </Annotations>\n    </ScalarVariable>\n";
  }
  return text;
}

std::string plain(const Variable& v) {
  constexpr const char* kTypes[] = {"", "Integer", "Real", "Boolean", "String"};
  return scalar(v.name, v.reference, v) + "      <" + kTypes[size_t(v.type)] + " start=\"" +
         std::string(v.start) + "\"/>\n    </ScalarVariable>\n";
}

std::string unknowns(const char* tag, Role role) {
  std::string text;
  uint32_t index = 1;
  for (const Variable& v : variables()) {
    const uint32_t parts = v.type == Type::kBinary ? 3 : 1;
    for (uint32_t k = 0; k < parts; ++k, ++index) {
      if (v.role == role) text += "      <Unknown index=\"" + std::to_string(index) + "\"/>\n";
    }
  }
  return "    <" + std::string(tag) + ">\n" + text + "    </" + tag + ">\n";
}

std::string text_with(const std::string& guid) {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"underbrush\" guid=\"" +
      guid +
      "\"\n    description=\"A lidar, from reflections or the ground truth to a list of objects\" "
      "author=\"The Underbrush developers\" version=\"0.1.0\" license=\"Apache-2.0\"\n"
      "    generationTool=\"Underbrush\" variableNamingConvention=\"structured\">\n"
      "  <CoSimulation modelIdentifier=\"underbrush\" "
      "canHandleVariableCommunicationStepSize=\"true\" "
      "canGetAndSetFMUstate=\"true\" canNotUseMemoryManagementFunctions=\"true\"/>\n"
      "  <LogCategories>\n    <Category name=\"input\" description=\"Inputs that cannot be "
      "used\"/>\n"
      "    <Category name=\"call\" description=\"Calls that are not allowed\"/>\n"
      "  </LogCategories>\n"
      "  <DefaultExperiment startTime=\"0.0\" stepSize=\"0.05\"/>\n"
      "  <VendorAnnotations>\n    <Tool name=\"net.pmsf.osmp\" "
      "xmlns:osmp=\"http://xsd.pmsf.net/OSISensorModelPackaging\">"
      "<osmp:osmp version=\"1.6.0\" osi-version=\"3.8.0\"/></Tool>\n  </VendorAnnotations>\n"
      "  <ModelVariables>\n";
  for (const Variable& v : variables()) text += v.type == Type::kBinary ? binary(v) : plain(v);
  return text + "  </ModelVariables>\n  <ModelStructure>\n" + unknowns("Outputs", Role::kOutput) +
         unknowns("InitialUnknowns", Role::kCalculatedParameter) +
         "  </ModelStructure>\n</fmiModelDescription>\n";
}

}  // namespace

std::span<const Variable> variables() { return kVariables; }

const Variable* find(uint32_t reference) {
  for (const Variable& v : kVariables) {
    const uint32_t parts = v.type == Type::kBinary ? 3 : 1;
    if (reference >= v.reference && reference < v.reference + parts) return &v;
  }
  return nullptr;
}

std::string description() { return text_with(guid()); }

std::string guid() {
  uint64_t high = 1, low = 2;
  for (const char c : text_with("")) {
    high = mix64(high ^ uint8_t(c));
    low = mix64(low + uint8_t(c) + high);
  }
  char text[40];
  std::snprintf(text, sizeof text, "{%08x-%04x-%04x-%04x-%012llx}", uint32_t(high >> 32),
                uint32_t(high >> 16) & 0xFFFF, uint32_t(high) & 0xFFFF, uint32_t(low >> 48),
                static_cast<unsigned long long>(low & 0xFFFFFFFFFFFFull));
  return text;
}

}  // namespace underbrush::fmu
