/// \file
/// The variables of the FMU, from which the model description and the value references come: a
/// table of the FMU's own, and rows of the tables of the verbs `osi` and `perceive`.
#pragma once
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace underbrush {
/// The FMU: a sensor model for co-simulation, with OSI messages as input and output.
namespace fmu {

/// The value references. A binary variable is three integers in FMI 2.0, as OSMP says: the lower
/// and upper half of an address, and a size. In FMI 3.0 it has the first reference of the three.
enum Reference : uint32_t {
  kSensorViewIn = 0,
  kSensorDataOut = 3,
  kSensorDataIn = 6,
  kSensorViewInConfigRequest = 9,
  kSensorViewInConfig = 12,
  kGroundTruthInit = 15,
  kCount = 18,
  kSeed = 19,
  kThreads = 20,
  kMaxEchoes = 21,
  kValid = 22,
  kCopySensorView = 23,
  kThresholdSnr = 24,
  kExistenceThreshold = 25,
  kLatencyMs = 26,
  kCycle = 27,
  kProfile = 28,
  kInputMode = 29,
  kChain = 30,
  kStrategies = 31,
  kTracking = 32,
  kWorld = 33,
  kTraceOutputPath = 34,
  kReferences = 35,
  kTime = kReferences  ///< The independent variable, which FMI 3.0 asks for.
};

/// The versions of FMI.
enum class Fmi : uint8_t { k2, k3 };

enum class Type : uint8_t { kBinary, kInteger, kReal, kBoolean, kString };
enum class Role : uint8_t { kInput, kOutput, kParameter, kCalculatedParameter };

/// A row of the table.
struct Variable {
  uint32_t reference;
  std::string_view name;
  Type type;
  Role role;
  std::string_view start;  ///< The initial value; for a binary variable, the OSI message.
  std::string meaning;     ///< A sentence for the model description.
  /// The limits of a parameter that is a number, both included.
  double least = -HUGE_VAL, most = HUGE_VAL;

  bool has_limits() const { return least > -HUGE_VAL; }
};

/// All variables, in order of reference.
std::span<const Variable> variables();
/// The row of a value reference and of the integers of a binary variable, or null.
const Variable* find(uint32_t reference);

/// The model description for a version of FMI.
std::string description(Fmi version);
/// The model's GUID, in FMI 3.0 the instantiation token: a hash of the description.
std::string guid(Fmi version);

}  // namespace fmu
}  // namespace underbrush
