// The parts that the benchmarks of tracing share: rays in the orders of the contestants, and rates
// that are measured in turns.
#pragma once
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "timing.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::bench {

using Json = nlohmann::ordered_json;
inline constexpr double kMaxRange = 120;  // m

/// Rays in firing order, as users have them, and in coherent tiles.
struct Rays {
  std::vector<Ray> firing, coherent;
  std::vector<uint64_t> keys;

  explicit Rays(std::vector<Ray> rays);
};

/// Measures the rays per second of each way in turns, so that a busy machine slows all alike; the
/// median counts.
class Contest {
 public:
  void add(std::string name, std::function<void()> f);
  Json rates(size_t rays, int rounds) const;

  /// Returns the instructions per ray of each way, in one run of one thread; null where the machine
  /// does not count them.
  Json instructions(size_t rays) const;

 private:
  std::vector<std::string> names_;
  std::vector<std::function<void()>> runs_;
};

/// Returns the largest of the rates whose names begin so.
double fastest(const Json& rates, const char* prefix);

/// Prints the result of `machine()`.
void print_machine(const Json& machine);

/// Returns the instruction sets of this machine.
std::vector<trace::Isa> instruction_sets();

void trace_all(const trace::World& world, const Rays& rays, std::vector<trace::Intersection>& met);

/// Traces rays through a model `passes` times with one thread, for bench/gates.py and profilers,
/// and prints the rate.
int trace_passes(int passes, const elements::Model& model, std::vector<Ray> rays,
                 const std::string& isa);

}  // namespace underbrush::bench
