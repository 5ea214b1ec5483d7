// The functions of FMI 3.0 that a co-simulation FMU exports (fmi-standard.org, FMI 3.0.2).
#include <memory>

#include "fmi3_types.h"
#include "instance.hpp"

// NOLINTBEGIN(readability-identifier-naming): the names are those of the standard.
namespace {

namespace fmu = underbrush::fmu;
using fmu::CallError;
using fmu::Instance;
using fmu::Type;

Instance* of(fmi3Instance c) { return static_cast<Instance*>(c); }

// Runs `action` on the instance if its phase is one of `allowed`.
template <class Action>
fmi3Status call(fmi3Instance c, const char* function, unsigned allowed, Action&& action) {
  if (!c) return fmi3Error;
  return fmi3Status(of(c)->call(function, allowed, [&] { action(*of(c)); }));
}

fmi3Status unsupported(fmi3Instance c, const char* function) {
  return call(c, function, 0, [](Instance&) {});
}

// All variables are scalars, so that there are as many values as references.
void require_scalars(size_t references, size_t values) {
  if (references != values) throw CallError("the number of values is not that of the variables");
}

template <class Value>
fmi3Status get(fmi3Instance c, const char* function, Type type, const fmi3ValueReference r[],
               size_t n, Value v[], size_t values) {
  return call(c, function, fmu::kAlive, [&](Instance& i) {
    require_scalars(n, values);
    i.get(type, r, n, v);
  });
}

template <class Value>
fmi3Status set(fmi3Instance c, const char* function, Type type, const fmi3ValueReference r[],
               size_t n, const Value v[], size_t values) {
  return call(c, function, fmu::kSettable, [&](Instance& i) {
    require_scalars(n, values);
    i.set(type, r, n, v);
  });
}

}  // namespace

extern "C" {

const char* fmi3GetVersion() { return "3.0"; }

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t count,
                               const fmi3String categories[]) {
  return call(c, "fmi3SetDebugLogging", fmu::kAlive | fmu::kError, [&](Instance& i) {
    if (count > 0 && !categories) throw CallError("a null pointer");
    i.is_logging = on;
  });
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                         fmi3Boolean, fmi3Boolean logs, fmi3Boolean with_events,
                                         fmi3Boolean, const fmi3ValueReference[], size_t,
                                         fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback) {
  if (!name || !*name) return nullptr;
  try {
    const auto logger = [environment, log](fmu::Status status, const char* category,
                                           const char* text) {
      if (log) log(environment, fmi3Status(status), category, text);
    };
    auto instance =
        std::make_unique<Instance>(fmu::Fmi::k3, resources ? resources : "", logger, logs);
    const auto refuse = [&](const char* reason) {
      instance->log(fmu::Status::kError, "call",
                    std::string("fmi3InstantiateCoSimulation: ") + reason);
      return nullptr;
    };
    if (!token || fmu::guid(fmu::Fmi::k3) != token) {
      return refuse("the instantiation token is not that of this model");
    }
    if (with_events) return refuse("the model has no event mode");
    return instance.release();
  } catch (...) {
    return nullptr;
  }
}
fmi3Instance fmi3InstantiateModelExchange() { return nullptr; }
fmi3Instance fmi3InstantiateScheduledExecution() { return nullptr; }

void fmi3FreeInstance(fmi3Instance c) {
  call(c, "fmi3FreeInstance", ~0u, [](Instance& i) { i.model.stop(); });
  delete of(c);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean, fmi3Float64, fmi3Float64 start,
                                       fmi3Boolean, fmi3Float64) {
  return call(c, "fmi3EnterInitializationMode", fmu::kInstantiated, [&](Instance& i) {
    i.set_start(start);
    i.phase = fmu::kInitialization;
  });
}
fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
  if (!c) return fmi3Error;
  return fmi3Status(of(c)->finish_initialization("fmi3ExitInitializationMode"));
}
fmi3Status fmi3Terminate(fmi3Instance c) {
  return call(c, "fmi3Terminate", fmu::kStepping, [](Instance& i) { i.terminate(); });
}
fmi3Status fmi3Reset(fmi3Instance c) {
  return call(c, "fmi3Reset", fmu::kAlive | fmu::kError, [](Instance& i) { i.reset(); });
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 v[],
                          size_t values) {
  return get(c, "fmi3GetFloat64", Type::kReal, r, n, v, values);
}
fmi3Status fmi3GetInt32(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Int32 v[],
                        size_t values) {
  return get(c, "fmi3GetInt32", Type::kInteger, r, n, v, values);
}
fmi3Status fmi3GetBoolean(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Boolean v[],
                          size_t values) {
  return get(c, "fmi3GetBoolean", Type::kBoolean, r, n, v, values);
}
fmi3Status fmi3GetString(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3String v[],
                         size_t values) {
  return get(c, "fmi3GetString", Type::kString, r, n, v, values);
}
fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t n, size_t sizes[],
                         fmi3Binary v[], size_t values) {
  return call(c, "fmi3GetBinary", fmu::kAlive, [&](Instance& i) {
    require_scalars(n, values);
    i.get_binary(r, n, sizes, v);
  });
}
fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                          const fmi3Float64 v[], size_t values) {
  return set(c, "fmi3SetFloat64", Type::kReal, r, n, v, values);
}
fmi3Status fmi3SetInt32(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Int32 v[],
                        size_t values) {
  return set(c, "fmi3SetInt32", Type::kInteger, r, n, v, values);
}
fmi3Status fmi3SetBoolean(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                          const fmi3Boolean v[], size_t values) {
  return set(c, "fmi3SetBoolean", Type::kBoolean, r, n, v, values);
}
fmi3Status fmi3SetString(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                         const fmi3String v[], size_t values) {
  return set(c, "fmi3SetString", Type::kString, r, n, v, values);
}
fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                         const size_t sizes[], const fmi3Binary v[], size_t values) {
  return call(c, "fmi3SetBinary", fmu::kSettable, [&](Instance& i) {
    require_scalars(n, values);
    i.set_binary(r, n, sizes, v);
  });
}

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState* state) {
  return call(c, "fmi3GetFMUState", fmu::kAlive | fmu::kError, [&](Instance& i) { i.save(state); });
}
fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) {
  return call(c, "fmi3SetFMUState", fmu::kAlive | fmu::kError,
              [&](Instance& i) { i.restore(state); });
}
fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState* state) {
  return call(c, "fmi3FreeFMUState", fmu::kAlive | fmu::kError,
              [&](Instance&) { Instance::forget(state); });
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 now, fmi3Float64 step, fmi3Boolean,
                      fmi3Boolean* event, fmi3Boolean* end, fmi3Boolean* early, fmi3Float64* last) {
  return call(c, "fmi3DoStep", fmu::kStepping, [&](Instance& i) {
    i.step("fmi3DoStep", now, step);
    for (fmi3Boolean* flag : {event, end, early}) {
      if (flag) *flag = false;
    }
    if (last) *last = i.time_s;
  });
}

// Functions without a use here. They return an error and read no argument but the instance, so
// that they are declared without the others, which the platform's way of calling allows.
#define UNDERBRUSH_UNSUPPORTED(name) \
  fmi3Status name(fmi3Instance c) { return unsupported(c, #name); }
#define UNDERBRUSH_NO_TYPE(type) \
  UNDERBRUSH_UNSUPPORTED(fmi3Get##type) UNDERBRUSH_UNSUPPORTED(fmi3Set##type)

UNDERBRUSH_NO_TYPE(Float32)
UNDERBRUSH_NO_TYPE(Int8)
UNDERBRUSH_NO_TYPE(UInt8)
UNDERBRUSH_NO_TYPE(Int16)
UNDERBRUSH_NO_TYPE(UInt16)
UNDERBRUSH_NO_TYPE(UInt32)
UNDERBRUSH_NO_TYPE(Int64)
UNDERBRUSH_NO_TYPE(UInt64)
UNDERBRUSH_NO_TYPE(Clock)
UNDERBRUSH_NO_TYPE(IntervalDecimal)
UNDERBRUSH_NO_TYPE(IntervalFraction)
UNDERBRUSH_NO_TYPE(ShiftDecimal)
UNDERBRUSH_NO_TYPE(ShiftFraction)
UNDERBRUSH_NO_TYPE(ContinuousStates)
UNDERBRUSH_UNSUPPORTED(fmi3EnterEventMode)
UNDERBRUSH_UNSUPPORTED(fmi3EnterStepMode)
UNDERBRUSH_UNSUPPORTED(fmi3EnterConfigurationMode)
UNDERBRUSH_UNSUPPORTED(fmi3ExitConfigurationMode)
UNDERBRUSH_UNSUPPORTED(fmi3EnterContinuousTimeMode)
UNDERBRUSH_UNSUPPORTED(fmi3GetNumberOfVariableDependencies)
UNDERBRUSH_UNSUPPORTED(fmi3GetVariableDependencies)
UNDERBRUSH_UNSUPPORTED(fmi3SerializedFMUStateSize)
UNDERBRUSH_UNSUPPORTED(fmi3SerializeFMUState)
UNDERBRUSH_UNSUPPORTED(fmi3DeserializeFMUState)
UNDERBRUSH_UNSUPPORTED(fmi3GetDirectionalDerivative)
UNDERBRUSH_UNSUPPORTED(fmi3GetAdjointDerivative)
UNDERBRUSH_UNSUPPORTED(fmi3EvaluateDiscreteStates)
UNDERBRUSH_UNSUPPORTED(fmi3UpdateDiscreteStates)
UNDERBRUSH_UNSUPPORTED(fmi3CompletedIntegratorStep)
UNDERBRUSH_UNSUPPORTED(fmi3SetTime)
UNDERBRUSH_UNSUPPORTED(fmi3GetContinuousStateDerivatives)
UNDERBRUSH_UNSUPPORTED(fmi3GetEventIndicators)
UNDERBRUSH_UNSUPPORTED(fmi3GetNominalsOfContinuousStates)
UNDERBRUSH_UNSUPPORTED(fmi3GetNumberOfEventIndicators)
UNDERBRUSH_UNSUPPORTED(fmi3GetNumberOfContinuousStates)
UNDERBRUSH_UNSUPPORTED(fmi3GetOutputDerivatives)
UNDERBRUSH_UNSUPPORTED(fmi3ActivateModelPartition)

}  // extern "C"
// NOLINTEND(readability-identifier-naming)
