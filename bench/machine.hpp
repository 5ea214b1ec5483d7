// The facts about the machine that a benchmark runs on, so that rates of two machines can be
// compared.
#pragma once
#include <nlohmann/json.hpp>
#include <optional>

namespace underbrush::bench {

/// Returns the processor's name, the number of its cores, and the clock (GHz) at which a chain of
/// multiplications just ran.
nlohmann::ordered_json machine();

/// Counts the instructions of this thread between its making and `count`, where the kernel lets a
/// program read the processor's counter. Virtual machines seldom do.
class InstructionCounter {
 public:
  InstructionCounter();
  InstructionCounter(const InstructionCounter&) = delete;
  InstructionCounter& operator=(const InstructionCounter&) = delete;
  ~InstructionCounter();
  std::optional<double> count() const;

 private:
  int file_ = -1;
};

}  // namespace underbrush::bench
