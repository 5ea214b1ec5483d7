#include "instance.hpp"

#include <cmath>

#include "states.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::fmu {
namespace {

void require_pointers(size_t count, const void* a, const void* b) {
  if (count > 0 && (!a || !b)) throw CallError("a null pointer");
}

}  // namespace

Instance::Instance(Fmi of_version, std::string resources, Logger to, bool logs)
    : version(of_version),
      logger(std::move(to)),
      is_logging(logs),
      model(std::move(resources),
            [this](const std::string& text) { log(Status::kWarning, "input", text); }) {}

void Instance::log(Status status, const char* category, const std::string& text) const {
  const bool is_heard = is_logging || status == Status::kError || status == Status::kWarning;
  if (logger && is_heard) logger(status, category, printable(text).c_str());
}

void Instance::set_start(double start_s) {
  if (!std::isfinite(start_s)) throw CallError("the start time is not finite");
  time_s = start_s;
}

Status Instance::finish_initialization(const char* function) {
  const Status status = call(function, kInitialization, [&] { model.start(); });
  if (phase == kInitialization) phase = status == Status::kOk ? kStepping : kError;
  return status;
}

void Instance::step(const char* function, double now_s, double step_s) {
  if (!std::isfinite(now_s) || !std::isfinite(step_s) || step_s < 0) {
    throw CallError("the time is not finite or goes back");
  }
  if (now_s < time_s - kSameTimeS) {
    log(Status::kWarning, "call",
        std::string(function) + ": the step begins before the last one ended");
  }
  model.step();
  time_s = now_s + step_s;
}

void Instance::terminate() {
  phase = kTerminated;
  model.stop();
}

void Instance::reset() {
  phase = kInstantiated;
  time_s = 0;
  model.reset();
}

void Instance::save(void** state) const {
  if (!state) throw CallError("a null pointer");
  SavedState saved{model.snapshot(), phase, time_s};
  forget_state(*state);  // before the new one, which may come to stand in its place
  *state = nullptr;
  *state = keep_state(std::move(saved));
}

void Instance::restore(const void* state) {
  if (!state) throw CallError("a null pointer");
  const auto saved = state_of(state);
  if (!saved) throw CallError("there is no such state");
  model.restore(saved->snapshot);
  phase = saved->phase;
  time_s = saved->time_s;
}

void Instance::forget(void** state) {
  if (!state || !*state) return;
  if (!forget_state(*state)) throw CallError("there is no such state");
  *state = nullptr;
}

// FMI 2.0 has no binary variables: there they are integers.
const Variable& Instance::variable(Type type, uint32_t reference) const {
  const Variable* v = find(reference);
  const bool is_part = v && v->type == Type::kBinary && version == Fmi::k2;
  const bool fits =
      v && (is_part ? type == Type::kInteger : v->type == type && v->reference == reference);
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

// What is computed only if somebody asks for it.
void Instance::prepare(const Variable& v) {
  if (v.role == Role::kCalculatedParameter && phase == kInitialization) model.request();
}

template <class Value>
void Instance::get(Type type, const uint32_t* references, size_t count, Value* values) {
  require_pointers(count, references, values);
  for (size_t k = 0; k < count; ++k) {
    if constexpr (std::is_same_v<Value, double>) {
      if (references[k] == kTime && version == Fmi::k3) {
        values[k] = time_s;
        continue;
      }
    }
    prepare(variable(type, references[k]));
    if constexpr (std::is_same_v<Value, double>) {
      values[k] = model.values.real[references[k]];
    } else if constexpr (std::is_same_v<Value, const char*>) {
      values[k] = model.values.text[references[k]].c_str();
    } else {
      values[k] = Value(model.values.integer[references[k]]);
    }
  }
}

template <class Value>
void Instance::set(Type type, const uint32_t* references, size_t count, const Value* values) {
  require_pointers(count, references, values);
  for (size_t k = 0; k < count; ++k) {
    check_set(variable(type, references[k]));
    if constexpr (std::is_same_v<Value, double>) {
      if (!std::isfinite(values[k])) throw CallError("not a finite number");
      model.values.real[references[k]] = values[k];
    } else if constexpr (std::is_same_v<Value, const char*>) {
      if (!values[k]) throw CallError("a null string");
      model.values.text[references[k]] = values[k];
    } else {
      model.values.integer[references[k]] = int32_t(values[k]);
    }
  }
}

void Instance::get_binary(const uint32_t* references, size_t count, size_t* sizes,
                          const uint8_t** values) {
  require_pointers(count, references, values);
  require_pointers(count, sizes, values);
  for (size_t k = 0; k < count; ++k) {
    prepare(variable(Type::kBinary, references[k]));
    const std::string_view bytes = model.bytes(references[k]);
    sizes[k] = bytes.size();
    values[k] = reinterpret_cast<const uint8_t*>(bytes.empty() ? "" : bytes.data());
  }
}

void Instance::set_binary(const uint32_t* references, size_t count, const size_t* sizes,
                          const uint8_t* const* values) {
  require_pointers(count, references, values);
  require_pointers(count, sizes, values);
  for (size_t k = 0; k < count; ++k) {
    check_set(variable(Type::kBinary, references[k]));
    if (sizes[k] > 0 && !values[k]) throw CallError("a null pointer");
    if (sizes[k] > size_t(INT32_MAX)) throw CallError("a message larger than 2 GiB");
    model.set_bytes(references[k], {reinterpret_cast<const char*>(values[k]), sizes[k]});
  }
}

template void Instance::get<int32_t>(Type, const uint32_t*, size_t, int32_t*);
template void Instance::get<bool>(Type, const uint32_t*, size_t, bool*);
template void Instance::get<double>(Type, const uint32_t*, size_t, double*);
template void Instance::get<const char*>(Type, const uint32_t*, size_t, const char**);
template void Instance::set<int32_t>(Type, const uint32_t*, size_t, const int32_t*);
template void Instance::set<bool>(Type, const uint32_t*, size_t, const bool*);
template void Instance::set<double>(Type, const uint32_t*, size_t, const double*);
template void Instance::set<const char*>(Type, const uint32_t*, size_t, const char* const*);

std::string path_of_uri(const std::string& uri) {
  std::string path = uri;
  for (const std::string scheme : {"file://localhost/", "file:///", "file:/"}) {
    if (path.rfind(scheme, 0) == 0) {
      path = path.substr(scheme.size() - 1);
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

}  // namespace underbrush::fmu
