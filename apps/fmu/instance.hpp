/// \file
/// An instance of the FMU: the model, and the states that FMI's calls lead through. It is the same
/// for both versions of FMI.
#pragma once
#include <functional>
#include <stdexcept>
#include <string>

#include "model.hpp"

namespace underbrush::fmu {

/// The states of co-simulation, as bits.
enum Phase : unsigned {
  kInstantiated = 1,
  kInitialization = 2,
  kStepping = 4,
  kTerminated = 8,
  kError = 16
};
inline constexpr unsigned kAlive = kInstantiated | kInitialization | kStepping | kTerminated;
inline constexpr unsigned kSettable = kInstantiated | kInitialization | kStepping;

/// What a call returns, with the numbers that both versions of FMI give it.
enum class Status : uint8_t { kOk, kWarning, kDiscard, kError };

/// A call that FMI does not allow.
class CallError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An instance.
struct Instance {
  /// The environment's logger: status, category and text.
  using Logger = std::function<void(Status, const char*, const char*)>;
  Instance(Fmi version, std::string resources, Logger logger, bool logs);

  /// Calls the environment's logger, on the thread of the present call.
  void log(Status status, const char* category, const std::string& text) const;
  /// Runs `action` if the phase is one of `allowed`. No exception leaves it.
  template <class Action>
  Status call(const char* function, unsigned allowed, Action&& action) {
    try {
      if (!(phase & allowed)) throw CallError("not allowed now");
      action();
      return Status::kOk;
    } catch (const std::bad_alloc&) {
      log(Status::kError, "call", std::string(function) + ": out of memory");
    } catch (const std::exception& e) {
      log(Status::kError, "call", std::string(function) + ": " + e.what());
    } catch (...) {
      log(Status::kError, "call", std::string(function) + ": failed");
    }
    return Status::kError;
  }

  /// Begins the simulation. Throws `CallError`.
  void set_start(double start_s);
  /// Ends the initialisation. Afterwards the phase says whether it succeeded.
  Status finish_initialization(const char* function);
  /// A step from `now_s` on. Throws `CallError`.
  void step(const char* function, double now_s, double step_s);
  void terminate();
  void reset();

  /// Writes a copy of the state to `state`, in place of the one that it has. Throws `CallError`.
  void save(void** state) const;
  void restore(const void* state);
  static void forget(void** state);

  /// Gets or sets `count` values of a type. Throws `CallError`.
  template <class Value>
  void get(Type type, const uint32_t* references, size_t count, Value* values);
  template <class Value>
  void set(Type type, const uint32_t* references, size_t count, const Value* values);
  /// The same for FMI 3.0's binary values. What is set is copied.
  void get_binary(const uint32_t* references, size_t count, size_t* sizes, const uint8_t** values);
  void set_binary(const uint32_t* references, size_t count, const size_t* sizes,
                  const uint8_t* const* values);

  Fmi version;
  Logger logger;
  bool is_logging;
  unsigned phase = kInstantiated;
  double time_s = 0;  ///< Where the last step ended.
  Model model;

 private:
  const Variable& variable(Type type, uint32_t reference) const;
  void check_set(const Variable& v) const;
  void prepare(const Variable& v);
};

/// The path of a file URI, with or without a host; another text stays as it is.
std::string path_of_uri(const std::string& uri);

}  // namespace underbrush::fmu
