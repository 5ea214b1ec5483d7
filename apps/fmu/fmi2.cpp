// The functions of FMI 2.0 that a co-simulation FMU exports (fmi-standard.org, FMI 2.0.4).
#include <cmath>

#include "instance.hpp"
#include "underbrush/core/check.hpp"

// NOLINTBEGIN(readability-identifier-naming): the names are those of the standard.
namespace {

using namespace underbrush::fmu;
using underbrush::fmu::Instance;

constexpr double kSameTime = 1e-6;

Instance* of(fmi2Component c) { return static_cast<Instance*>(c); }

// The path of a file URI, with or without a host.
std::string path_of(const std::string& uri) {
  std::string path = uri;
  for (const char* scheme : {"file://localhost/", "file:///", "file:/"}) {
    const std::string text(scheme);
    if (path.rfind(text, 0) == 0) {
      path = path.substr(text.size() - 1);
      break;
    }
  }
  std::string out;
  for (size_t k = 0; k < path.size(); ++k) {
    unsigned code = 0;
    if (path[k] == '%' && k + 2 < path.size() &&
        std::sscanf(path.c_str() + k + 1, "%2x", &code) == 1) {
      out += char(code);
      k += 2;
    } else {
      out += path[k];
    }
  }
  return out;
}

fmi2Status no_instance() { return fmi2Error; }

fmi2Status unsupported(fmi2Component c, const char* function) {
  if (!c) return no_instance();
  return of(c)->call(function, 0, [] {});
}

}  // namespace

extern "C" {

const char* fmi2GetTypesPlatform() { return "default"; }
const char* fmi2GetVersion() { return "2.0"; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count,
                               const fmi2String categories[]) {
  if (!c) return no_instance();
  return of(c)->call("fmi2SetDebugLogging", kAlive | kError, [&] {
    if (count > 0 && !categories) throw CallError("a null pointer");
    of(c)->is_logging = on != 0;
  });
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions* functions, fmi2Boolean,
                              fmi2Boolean logs) {
  if (!functions || !name || !*name) return nullptr;
  try {
    auto instance = std::make_unique<Instance>(name, path_of(resources ? resources : ""),
                                               *functions, logs != 0);
    if (type != fmi2CoSimulation) {
      instance->log(fmi2Error, "call", "fmi2Instantiate: only co-simulation is possible");
      return nullptr;
    }
    if (!guid || underbrush::fmu::guid() != guid) {
      instance->log(fmi2Error, "call", "fmi2Instantiate: the GUID is not that of this model");
      return nullptr;
    }
    return instance.release();
  } catch (...) {
    return nullptr;
  }
}

void fmi2FreeInstance(fmi2Component c) {
  if (!c) return;
  of(c)->call("fmi2FreeInstance", ~0u, [&] { of(c)->model.stop(); });
  delete of(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean, fmi2Real, fmi2Real start, fmi2Boolean,
                               fmi2Real) {
  if (!c) return no_instance();
  return of(c)->call("fmi2SetupExperiment", kInstantiated, [&] {
    if (!std::isfinite(start)) throw CallError("the start time is not finite");
    of(c)->time_s = start;
  });
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  if (!c) return no_instance();
  return of(c)->call("fmi2EnterInitializationMode", kInstantiated,
                     [&] { of(c)->phase = kInitialization; });
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  if (!c) return no_instance();
  const fmi2Status status =
      of(c)->call("fmi2ExitInitializationMode", kInitialization, [&] { of(c)->model.start(); });
  if (of(c)->phase == kInitialization) of(c)->phase = status == fmi2OK ? kStepping : kError;
  return status;
}

fmi2Status fmi2Terminate(fmi2Component c) {
  if (!c) return no_instance();
  return of(c)->call("fmi2Terminate", kStepping, [&] {
    of(c)->phase = kTerminated;
    of(c)->model.stop();
  });
}

fmi2Status fmi2Reset(fmi2Component c) {
  if (!c) return no_instance();
  return of(c)->call("fmi2Reset", kAlive | kError, [&] {
    of(c)->phase = kInstantiated;
    of(c)->time_s = 0;
    of(c)->model.reset();
  });
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Real v[]) {
  if (!c) return no_instance();
  return of(c)->call("fmi2GetReal", kAlive, [&] { of(c)->get(Type::kReal, r, n, v); });
}
fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n,
                          fmi2Integer v[]) {
  if (!c) return no_instance();
  return of(c)->call("fmi2GetInteger", kAlive, [&] { of(c)->get(Type::kInteger, r, n, v); });
}
fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n,
                          fmi2Boolean v[]) {
  if (!c) return no_instance();
  return of(c)->call("fmi2GetBoolean", kAlive, [&] { of(c)->get(Type::kBoolean, r, n, v); });
}
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String v[]) {
  if (!c) return no_instance();
  return of(c)->call("fmi2GetString", kAlive, [&] { of(c)->get(Type::kString, r, n, v); });
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference r[], size_t n,
                       const fmi2Real v[]) {
  if (!c) return no_instance();
  return of(c)->call("fmi2SetReal", kAlive & ~kTerminated,
                     [&] { of(c)->set(Type::kReal, r, n, v); });
}
fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n,
                          const fmi2Integer v[]) {
  if (!c) return no_instance();
  return of(c)->call("fmi2SetInteger", kAlive & ~kTerminated,
                     [&] { of(c)->set(Type::kInteger, r, n, v); });
}
fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n,
                          const fmi2Boolean v[]) {
  if (!c) return no_instance();
  return of(c)->call("fmi2SetBoolean", kAlive & ~kTerminated,
                     [&] { of(c)->set(Type::kBoolean, r, n, v); });
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n,
                         const fmi2String v[]) {
  if (!c) return no_instance();
  return of(c)->call("fmi2SetString", kAlive & ~kTerminated,
                     [&] { of(c)->set(Type::kString, r, n, v); });
}

// A state is a copy of the model with its phase and time.
struct SavedState {
  underbrush::fmu::Snapshot snapshot;
  unsigned phase;
  double time_s;
};

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* state) {
  if (!c) return no_instance();
  return of(c)->call("fmi2GetFMUstate", kAlive | kError, [&] {
    if (!state) throw CallError("a null pointer");
    auto saved = std::make_unique<SavedState>(
        SavedState{of(c)->model.snapshot(), of(c)->phase, of(c)->time_s});
    delete static_cast<SavedState*>(*state);
    *state = saved.release();
  });
}
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
  if (!c) return no_instance();
  return of(c)->call("fmi2SetFMUstate", kAlive | kError, [&] {
    if (!state) throw CallError("a null pointer");
    const auto* saved = static_cast<const SavedState*>(state);
    of(c)->model.restore(saved->snapshot);
    of(c)->phase = saved->phase;
    of(c)->time_s = saved->time_s;
  });
}
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate* state) {
  if (!c) return no_instance();
  return of(c)->call("fmi2FreeFMUstate", kAlive | kError, [&] {
    if (!state) return;
    delete static_cast<SavedState*>(*state);
    *state = nullptr;
  });
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
  if (!c) return no_instance();
  return of(c)->call("fmi2DoStep", kStepping, [&] {
    if (!std::isfinite(now) || !std::isfinite(step) || step < 0) {
      throw CallError("the time is not finite or goes back");
    }
    if (now < of(c)->time_s - kSameTime) {
      of(c)->log(fmi2Warning, "call", "fmi2DoStep: the step begins before the last one ended");
    }
    of(c)->model.step();
    of(c)->time_s = now + step;
  });
}
fmi2Status fmi2CancelStep(fmi2Component c) { return unsupported(c, "fmi2CancelStep"); }
fmi2Status fmi2GetStatus(fmi2Component c, fmi2StatusKind, fmi2Status*) {
  return unsupported(c, "fmi2GetStatus");
}
fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real* value) {
  if (!c) return no_instance();
  return of(c)->call("fmi2GetRealStatus", kStepping | kTerminated, [&] {
    if (kind != fmi2LastSuccessfulTime || !value) throw CallError("only the last time is known");
    *value = of(c)->time_s;
  });
}
fmi2Status fmi2GetIntegerStatus(fmi2Component c, fmi2StatusKind, fmi2Integer*) {
  return unsupported(c, "fmi2GetIntegerStatus");
}
fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind, fmi2Boolean* value) {
  if (!c) return no_instance();
  return of(c)->call("fmi2GetBooleanStatus", kStepping | kTerminated, [&] {
    if (kind != fmi2Terminated || !value)
      throw CallError("only the end of the simulation is known");
    *value = 0;
  });
}
fmi2Status fmi2GetStringStatus(fmi2Component c, fmi2StatusKind, fmi2String*) {
  return unsupported(c, "fmi2GetStringStatus");
}

}  // extern "C"
// NOLINTEND(readability-identifier-naming)
