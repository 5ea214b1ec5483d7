#include "instance.hpp"

#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::fmu {

Instance::Instance(std::string instance_name, std::string resources,
                   const fmi2CallbackFunctions& functions, bool logs)
    : name(std::move(instance_name)),
      callbacks(functions),
      is_logging(logs),
      model(std::move(resources),
            [this](const std::string& text) { log(fmi2Warning, "input", text); }) {}

void Instance::log(fmi2Status status, const char* category, const std::string& text) const {
  const bool is_fault = status >= fmi2Error;
  if (!callbacks.logger || !(is_logging || is_fault || status == fmi2Warning)) return;
  callbacks.logger(callbacks.componentEnvironment, name.c_str(), status, category, "%s",
                   printable(text).c_str());
}

// A binary variable is three integers.
const Variable& Instance::variable(Type type, fmi2ValueReference reference) const {
  const Variable* v = find(reference);
  const bool fits = v && (v->type == type || (type == Type::kInteger && v->type == Type::kBinary));
  if (!fits) {
    throw CallError("no variable of this type has the value reference " +
                    std::to_string(reference));
  }
  return *v;
}

void Instance::check_set(const Variable& v) const {
  if (v.role == Role::kOutput || v.role == Role::kCalculatedParameter) {
    throw CallError(std::string(v.name) + " is computed and cannot be set");
  }
  if (v.role == Role::kParameter && phase == kStepping) {
    throw CallError(std::string(v.name) + " is fixed once the simulation runs");
  }
}

template <class Value>
void Instance::get(Type type, const fmi2ValueReference* references, size_t count, Value* values) {
  if (count > 0 && (!references || !values)) throw CallError("a null pointer");
  for (size_t k = 0; k < count; ++k) {
    const Variable& v = variable(type, references[k]);
    if (v.role == Role::kCalculatedParameter && phase == kInitialization) model.request();
    if constexpr (std::is_same_v<Value, fmi2Real>) {
      values[k] = model.values.real[references[k]];
    } else if constexpr (std::is_same_v<Value, fmi2String>) {
      values[k] = model.values.text[references[k]].c_str();
    } else {
      values[k] = model.values.integer[references[k]];
    }
  }
}

template <class Value>
void Instance::set(Type type, const fmi2ValueReference* references, size_t count,
                   const Value* values) {
  if (count > 0 && (!references || !values)) throw CallError("a null pointer");
  for (size_t k = 0; k < count; ++k) {
    check_set(variable(type, references[k]));
    if constexpr (std::is_same_v<Value, fmi2Real>) {
      if (!std::isfinite(values[k])) throw CallError("not a finite number");
      model.values.real[references[k]] = values[k];
    } else if constexpr (std::is_same_v<Value, fmi2String>) {
      if (!values[k]) throw CallError("a null string");
      model.values.text[references[k]] = values[k];
    } else {
      model.values.integer[references[k]] = values[k];
    }
  }
}

template void Instance::get<fmi2Integer>(Type, const fmi2ValueReference*, size_t, fmi2Integer*);
template void Instance::get<fmi2Real>(Type, const fmi2ValueReference*, size_t, fmi2Real*);
template void Instance::get<fmi2String>(Type, const fmi2ValueReference*, size_t, fmi2String*);
template void Instance::set<fmi2Integer>(Type, const fmi2ValueReference*, size_t,
                                         const fmi2Integer*);
template void Instance::set<fmi2Real>(Type, const fmi2ValueReference*, size_t, const fmi2Real*);
template void Instance::set<fmi2String>(Type, const fmi2ValueReference*, size_t, const fmi2String*);

}  // namespace underbrush::fmu
