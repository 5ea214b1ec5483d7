// Times as medians over runs.
#pragma once
#include <algorithm>
#include <chrono>
#include <vector>

namespace underbrush::bench {

inline constexpr double kHdl64eBeamsPerS = 1.33e6;
inline constexpr double kOs1BeamsPerS = 1.31072e6;  // 1024 × 64 at 20 Hz, or 2048 × 64 at 10 Hz

template <class F>
double seconds_of(F f) {
  const auto start = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

inline double median(std::vector<double> x) {
  std::nth_element(x.begin(), x.begin() + long(x.size() / 2), x.end());
  return x[x.size() / 2];
}

}  // namespace underbrush::bench
