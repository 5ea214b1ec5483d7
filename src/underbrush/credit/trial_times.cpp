#include "underbrush/credit/trial_times.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace underbrush::credit {
namespace {

constexpr double kTicksPerS = 64, kMostS = 86400;

void add_to(int64_t& sum, int64_t term) {
  std::atomic_ref<int64_t>(sum).fetch_add(term, std::memory_order_relaxed);
}

}  // namespace

void TimeSums::add_shared(double since_s) {
  const int64_t t = std::llround(std::clamp(since_s, -kMostS, kMostS) * kTicksPerS);
  add_to(count, 1);
  add_to(ticks, t);
  add_to(squares, t * t);
}

void TimeSums::add(const TimeSums& other) {
  count += other.count;
  ticks += other.ticks;
  squares += other.squares;
}

double TimeSums::spread_s() const {
  if (count == 0) return 0;
  const double n = double(count), mean = double(ticks) / n;
  return std::sqrt(std::max(0.0, double(squares) / n - mean * mean)) / kTicksPerS;
}

void TrialTimes::add(const TrialTimes& other) {
  hits.add(other.hits);
  misses.add(other.misses);
}

bool TrialTimes::are_brief() const {
  TimeSums all = hits;
  all.add(misses);
  const double spread = all.spread_s();
  return hits.count > 1 && spread > kLeastSpreadS && hits.spread_s() < kBriefSpread * spread;
}

}  // namespace underbrush::credit
