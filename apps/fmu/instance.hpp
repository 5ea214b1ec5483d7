/// \file
/// An instance of the FMU: the model, and the states that FMI's calls lead through.
#pragma once
#include <memory>
#include <stdexcept>
#include <string>

#include "fmi2_types.h"
#include "model.hpp"

namespace underbrush::fmu {

/// The states of FMI 2.0's co-simulation, as bits.
enum Phase : unsigned {
  kInstantiated = 1,
  kInitialization = 2,
  kStepping = 4,
  kTerminated = 8,
  kError = 16
};
inline constexpr unsigned kAlive = kInstantiated | kInitialization | kStepping | kTerminated;

/// A call that FMI does not allow.
class CallError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An instance.
struct Instance {
  Instance(std::string instance_name, std::string resources, const fmi2CallbackFunctions& functions,
           bool logs);

  /// Calls the environment's logger, on the thread of the present call.
  void log(fmi2Status status, const char* category, const std::string& text) const;
  /// Runs `action` if the phase is one of `allowed`. No exception leaves it.
  template <class Action>
  fmi2Status call(const char* function, unsigned allowed, Action&& action) {
    try {
      if (!(phase & allowed)) {
        log(fmi2Error, "call", std::string(function) + ": not allowed now");
        return fmi2Error;
      }
      action();
      return fmi2OK;
    } catch (const CallError& e) {
      log(fmi2Error, "call", std::string(function) + ": " + e.what());
    } catch (const std::bad_alloc&) {
      log(fmi2Error, "call", std::string(function) + ": out of memory");
    } catch (const std::exception& e) {
      log(fmi2Error, "call", std::string(function) + ": " + e.what());
    } catch (...) {
      log(fmi2Error, "call", std::string(function) + ": failed");
    }
    return fmi2Error;
  }

  std::string name;
  fmi2CallbackFunctions callbacks;
  bool is_logging;
  unsigned phase = kInstantiated;
  double time_s = 0;  ///< Where the last step ended.
  Model model;

  /// Gets or sets `count` values of a type. Throws `CallError`.
  template <class Value>
  void get(Type type, const fmi2ValueReference* references, size_t count, Value* values);
  template <class Value>
  void set(Type type, const fmi2ValueReference* references, size_t count, const Value* values);

 private:
  const Variable& variable(Type type, fmi2ValueReference reference) const;
  void check_set(const Variable& v) const;
};

}  // namespace underbrush::fmu
