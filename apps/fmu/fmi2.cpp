// The functions of FMI 2.0 that a co-simulation FMU exports (fmi-standard.org, FMI 2.0.4).
#include <memory>

#include "fmi2_types.h"
#include "instance.hpp"

// NOLINTBEGIN(readability-identifier-naming): the names are those of the standard.
namespace {

namespace fmu = underbrush::fmu;
using fmu::CallError;
using fmu::Instance;
using fmu::Type;

Instance* of(fmi2Component c) { return static_cast<Instance*>(c); }

// Runs `action` on the instance if its phase is one of `allowed`.
template <class Action>
fmi2Status call(fmi2Component c, const char* function, unsigned allowed, Action&& action) {
  if (!c) return fmi2Error;
  return fmi2Status(of(c)->call(function, allowed, [&] { action(*of(c)); }));
}

fmi2Status unsupported(fmi2Component c, const char* function) {
  return call(c, function, 0, [](Instance&) {});
}

template <class Value>
fmi2Status get(fmi2Component c, const char* function, Type type, const fmi2ValueReference r[],
               size_t n, Value v[]) {
  return call(c, function, fmu::kAlive, [&](Instance& i) { i.get(type, r, n, v); });
}

template <class Value>
fmi2Status set(fmi2Component c, const char* function, Type type, const fmi2ValueReference r[],
               size_t n, const Value v[]) {
  return call(c, function, fmu::kSettable, [&](Instance& i) { i.set(type, r, n, v); });
}

}  // namespace

extern "C" {

const char* fmi2GetTypesPlatform() { return "default"; }
const char* fmi2GetVersion() { return "2.0"; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count,
                               const fmi2String categories[]) {
  return call(c, "fmi2SetDebugLogging", fmu::kAlive | fmu::kError, [&](Instance& i) {
    if (count > 0 && !categories) throw CallError("a null pointer");
    i.is_logging = on != 0;
  });
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions* functions, fmi2Boolean,
                              fmi2Boolean logs) {
  if (!functions || !name || !*name) return nullptr;
  try {
    const auto logger = [to = *functions, instance = std::string(name)](
                            fmu::Status status, const char* category, const char* text) {
      if (!to.logger) return;
      to.logger(to.componentEnvironment, instance.c_str(), fmi2Status(status), category, "%s",
                text);
    };
    auto instance = std::make_unique<Instance>(
        fmu::Fmi::k2, fmu::path_of_uri(resources ? resources : ""), logger, logs != 0);
    if (type != fmi2CoSimulation) {
      instance->log(fmu::Status::kError, "call", "fmi2Instantiate: only co-simulation is possible");
      return nullptr;
    }
    if (!guid || fmu::guid(fmu::Fmi::k2) != guid) {
      instance->log(fmu::Status::kError, "call",
                    "fmi2Instantiate: the GUID is not that of this model");
      return nullptr;
    }
    return instance.release();
  } catch (...) {
    return nullptr;
  }
}

void fmi2FreeInstance(fmi2Component c) {
  call(c, "fmi2FreeInstance", ~0u, [](Instance& i) { i.model.stop(); });
  delete of(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean, fmi2Real, fmi2Real start, fmi2Boolean,
                               fmi2Real) {
  return call(c, "fmi2SetupExperiment", fmu::kInstantiated,
              [&](Instance& i) { i.set_start(start); });
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  return call(c, "fmi2EnterInitializationMode", fmu::kInstantiated,
              [](Instance& i) { i.phase = fmu::kInitialization; });
}
fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  if (!c) return fmi2Error;
  return fmi2Status(of(c)->finish_initialization("fmi2ExitInitializationMode"));
}
fmi2Status fmi2Terminate(fmi2Component c) {
  return call(c, "fmi2Terminate", fmu::kStepping, [](Instance& i) { i.terminate(); });
}
fmi2Status fmi2Reset(fmi2Component c) {
  return call(c, "fmi2Reset", fmu::kAlive | fmu::kError, [](Instance& i) { i.reset(); });
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Real v[]) {
  return get(c, "fmi2GetReal", Type::kReal, r, n, v);
}
fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n,
                          fmi2Integer v[]) {
  return get(c, "fmi2GetInteger", Type::kInteger, r, n, v);
}
fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n,
                          fmi2Boolean v[]) {
  return get(c, "fmi2GetBoolean", Type::kBoolean, r, n, v);
}
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String v[]) {
  return get(c, "fmi2GetString", Type::kString, r, n, v);
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference r[], size_t n,
                       const fmi2Real v[]) {
  return set(c, "fmi2SetReal", Type::kReal, r, n, v);
}
fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n,
                          const fmi2Integer v[]) {
  return set(c, "fmi2SetInteger", Type::kInteger, r, n, v);
}
fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n,
                          const fmi2Boolean v[]) {
  return set(c, "fmi2SetBoolean", Type::kBoolean, r, n, v);
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n,
                         const fmi2String v[]) {
  return set(c, "fmi2SetString", Type::kString, r, n, v);
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* state) {
  return call(c, "fmi2GetFMUstate", fmu::kAlive | fmu::kError, [&](Instance& i) { i.save(state); });
}
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
  return call(c, "fmi2SetFMUstate", fmu::kAlive | fmu::kError,
              [&](Instance& i) { i.restore(state); });
}
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate* state) {
  return call(c, "fmi2FreeFMUstate", fmu::kAlive | fmu::kError,
              [&](Instance&) { Instance::forget(state); });
}
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate, size_t*) {
  return unsupported(c, "fmi2SerializedFMUstateSize");
}
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate, fmi2Byte[], size_t) {
  return unsupported(c, "fmi2SerializeFMUstate");
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte[], size_t, fmi2FMUstate*) {
  return unsupported(c, "fmi2DeSerializeFMUstate");
}
fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference[], size_t,
                                        const fmi2ValueReference[], size_t, const fmi2Real[],
                                        fmi2Real[]) {
  return unsupported(c, "fmi2GetDirectionalDerivative");
}
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference[], size_t,
                                       const fmi2Integer[], const fmi2Real[]) {
  return unsupported(c, "fmi2SetRealInputDerivatives");
}
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference[], size_t,
                                        const fmi2Integer[], fmi2Real[]) {
  return unsupported(c, "fmi2GetRealOutputDerivatives");
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real now, fmi2Real step, fmi2Boolean) {
  return call(c, "fmi2DoStep", fmu::kStepping,
              [&](Instance& i) { i.step("fmi2DoStep", now, step); });
}
fmi2Status fmi2CancelStep(fmi2Component c) { return unsupported(c, "fmi2CancelStep"); }
fmi2Status fmi2GetStatus(fmi2Component c, fmi2StatusKind, fmi2Status*) {
  return unsupported(c, "fmi2GetStatus");
}
fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real* value) {
  return call(c, "fmi2GetRealStatus", fmu::kStepping | fmu::kTerminated, [&](Instance& i) {
    if (kind != fmi2LastSuccessfulTime || !value) throw CallError("only the last time is known");
    *value = i.time_s;
  });
}
fmi2Status fmi2GetIntegerStatus(fmi2Component c, fmi2StatusKind, fmi2Integer*) {
  return unsupported(c, "fmi2GetIntegerStatus");
}
fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind, fmi2Boolean* value) {
  return call(c, "fmi2GetBooleanStatus", fmu::kStepping | fmu::kTerminated, [&](Instance&) {
    if (kind != fmi2Terminated || !value) {
      throw CallError("only the end of the simulation is known");
    }
    *value = 0;
  });
}
fmi2Status fmi2GetStringStatus(fmi2Component c, fmi2StatusKind, fmi2String*) {
  return unsupported(c, "fmi2GetStringStatus");
}

}  // extern "C"
// NOLINTEND(readability-identifier-naming)
