/// \file
/// The sensor model behind the FMU's functions. It knows OSI, but not FMI.
#pragma once
#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "underbrush/osi/chain.hpp"
#include "underbrush/osi/profile.hpp"
#include "underbrush/osi/static_data.hpp"
#include "underbrush/osi/trace.hpp"
#include "variables.hpp"

namespace underbrush::fmu {

/// Times that differ by less are one time, s.
inline constexpr double kSameTimeS = 1e-6;

/// The values of all variables. A reference names a value of the type of its row.
struct Values {
  std::array<int32_t, kReferences> integer{};
  std::array<double, kReferences> real{};
  std::array<std::string, kReferences> text;
  Values();
};

/// The state that a model keeps from step to step.
struct Memory {
  osi::StaticData known;
  std::optional<osi::Timestamp> last;  ///< Time of the last input that was processed.
  std::array<std::string, 2> output;   ///< The last two output messages.
  size_t current = 0;                  ///< Which of them is the last one.
  bool is_valid = false;
  std::map<uint32_t, std::string> held;  ///< Copies of binary variables, by reference (FMI 3.0).
};

/// A copy of a model's state.
struct Snapshot {
  Values values;
  Memory memory;
  std::optional<osi::Chain> chain;
};

/// A sensor model.
class Model {
 public:
  using Warn = std::function<void(const std::string&)>;
  /// `warn` is called on the thread of the call that caused it.
  Model(std::filesystem::path resources, Warn warn);

  Values values;
  /// Ends the initialisation: reads the chain. Throws where it or a parameter is wrong.
  void start();
  /// Processes the inputs. Inputs that cannot be used are passed to `warn`, and the output then has
  /// the state that no data are available.
  void step();
  /// Ends the simulation: completes the output trace.
  void stop();
  /// Goes back to the state after the construction.
  void reset();
  /// Serialises the request to the environment simulator, if the parameters have changed, and sets
  /// the variable.
  void request();
  /// The bytes of a binary variable, empty if it has none.
  std::string_view bytes(uint32_t reference) const;
  /// Keeps a copy of the bytes of a binary variable, and has the variable point to it.
  void set_bytes(uint32_t reference, std::string_view bytes);
  Snapshot snapshot() const;
  void restore(const Snapshot& snapshot);

 private:
  void point_to(uint32_t reference, const std::string& bytes);
  osi::ChainFile chain_file() const;
  void set_parameters(osi::ChainFile& file) const;
  std::string in_resources(const std::string& word) const;
  std::string process();
  void note_ground_truth();

  std::filesystem::path resources_;
  Warn warn_;
  Memory memory_;
  std::optional<osi::Chain> chain_;
  std::optional<osi::TraceWriter> trace_;
  std::string requested_, request_of_;
};

}  // namespace underbrush::fmu
