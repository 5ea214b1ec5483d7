#include "machine.hpp"

#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>
#include <string>
#include <thread>

#include "timing.hpp"

namespace underbrush::bench {
namespace {

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

/// A multiplication waits three cycles for the one before, on all processors of the last 15 years.
/// Other programs make a run longer, never shorter, so the fastest of many counts.
double clock_ghz() {
  constexpr int kSteps = 100000, kRuns = 100, kUnrolled = 16;
  double fastest = 1e9;
  for (int run = 0; run < kRuns; ++run) {
    const double s = seconds_of([&] {
      uint64_t x = uint64_t(run);
      for (int k = 0; k < kSteps; ++k) {
        // One assembler line a step keeps the compiler from folding the chain into one addition.
        asm volatile(".rept %c1\n\timul $3, %0, %0\n\t.endr" : "+r"(x) : "i"(kUnrolled) : "cc");
      }
    });
    fastest = std::min(fastest, s);
  }
  return 1e-9 * 3 * kSteps * kUnrolled / fastest;
}

}  // namespace

nlohmann::ordered_json machine() {
  nlohmann::ordered_json j;
  j["processor"] = processor();
  j["cores"] = std::thread::hardware_concurrency();
  j["clock_ghz"] = clock_ghz();
  return j;
}

InstructionCounter::InstructionCounter() {
  perf_event_attr wanted{};
  wanted.size = sizeof(wanted);
  wanted.type = PERF_TYPE_HARDWARE;
  wanted.config = PERF_COUNT_HW_INSTRUCTIONS;
  wanted.exclude_kernel = wanted.exclude_hv = 1;
  file_ = int(syscall(SYS_perf_event_open, &wanted, 0, -1, -1, 0));
}

InstructionCounter::~InstructionCounter() {
  if (file_ >= 0) close(file_);
}

std::optional<double> InstructionCounter::count() const {
  uint64_t n = 0;
  if (file_ < 0 || read(file_, &n, sizeof(n)) != sizeof(n)) return std::nullopt;
  return double(n);
}

}  // namespace underbrush::bench
