#include "underbrush/sites/point_process.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/sites/arrangement.hpp"

namespace underbrush::sites {
namespace {

constexpr double kDistanceStepM = 0.5, kSpacingStep = 0.25;
constexpr size_t kLeastOfClass = 10;
constexpr int kRounds = 60, kAveraged = 30, kSweepsOfRound = 4;
constexpr double kStrongest = 5;  // Of the steps.
constexpr int kEvenDraws = 16;
constexpr double kLeastEven = 0.1;  // Pairs; fewer make no ratio.

/// The interval of distance by half metres.
constexpr auto kIntervalOf = [] {
  std::array<uint8_t, size_t(PairSteps::kReachM / kDistanceStepM)> out{};
  for (size_t k = 0; k < out.size(); ++k) {
    while (PairSteps::kDistances[out[k]] <= double(k) * kDistanceStepM) ++out[k];
  }
  return out;
}();

/// The number of a pair of kinds, whatever their order.
int pair_of(const MarkedPoint& a, const MarkedPoint& b) {
  const auto [low, high] =
      std::minmax({int(elements::kind_of(a.label)) - 1, int(elements::kind_of(b.label)) - 1});
  return low + high * (high + 1) / 2;
}

/// The sums of the relative places of the points of a class, and their number.
struct Places {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  size_t points = 0;
};

std::map<elements::Class, Places> places_of(const Window& window,
                                            std::span<const MarkedPoint> points) {
  std::map<elements::Class, Places> out;
  for (const MarkedPoint& p : points) {
    out[p.label].sum += window.relative(p.at);
    ++out[p.label].points;
  }
  return out;
}

/// Moves the parameters by `step` towards those at which the expected counts are those wanted.
void approach(const Window& window, const PairSteps& wanted,
              const std::map<elements::Class, Places>& where, const Arrangement& state, double step,
              PointProcess& process) {
  for (size_t k = 0; k < wanted.values.size(); ++k) {
    const double off = (wanted.values[k] - state.pairs().values[k]) / (wanted.values[k] + 1);
    double& value = process.steps.values[k];
    value = std::clamp(value + step * std::clamp(off, -1.0, 1.0), -kStrongest, kStrongest);
  }
  for (const auto& [label, now] : places_of(window, state.points())) {
    if (now.points < kLeastOfClass) continue;
    // The variance of a relative coordinate is about a third.
    process.gradient.try_emplace(label, Eigen::Vector2d::Zero()).first->second +=
        step * 3 * (where.at(label).sum - now.sum) / double(now.points);
  }
}

/// Adds `share` of the parameters of one process to those of another.
void add(const PointProcess& from, double share, PointProcess& to) {
  for (size_t k = 0; k < to.steps.values.size(); ++k) {
    to.steps.values[k] += share * from.steps.values[k];
  }
  for (const auto& [label, b] : from.gradient) {
    to.gradient.try_emplace(label, Eigen::Vector2d::Zero()).first->second += share * b;
  }
}

}  // namespace

void PairSteps::count(const MarkedPoint& a, const MarkedPoint& b, double distance_m, double n) {
  if (distance_m >= kReachM) return;
  double* of_pair = values.data() + size_t(pair_of(a, b)) * kIntervals;
  of_pair[kIntervalOf[size_t(distance_m / kDistanceStepM)]] += n;
  const double spacing = distance_m / std::max(a.radius_m + b.radius_m, 1e-3);
  if (spacing < kSpacings * kSpacingStep) {
    of_pair[kDistances.size() + size_t(spacing / kSpacingStep)] += n;
  }
}

PairSteps even_pairs(const Window& window, std::span<const MarkedPoint> points, uint64_t seed) {
  PairSteps out;
  std::vector<MarkedPoint> even(points.begin(), points.end());
  Stream random(seed);
  for (int k = 0; k < kEvenDraws; ++k) {
    for (MarkedPoint& p : even) p.at = window.draw(random);
    const PairSteps counted = Arrangement(window, even).pairs();
    for (size_t i = 0; i < out.values.size(); ++i) out.values[i] += counted.values[i] / kEvenDraws;
  }
  return out;
}

PointProcess fit_process(const Window& window, std::span<const MarkedPoint> points, uint64_t seed) {
  PointProcess process, mean;
  if (points.empty()) return process;
  require(!window.is_empty(), "the window of a point process is empty");
  const PairSteps wanted = Arrangement(window, points).pairs();
  const std::map<elements::Class, Places> where = places_of(window, points);
  std::vector<MarkedPoint> start(points.begin(), points.end());
  Stream random(seed);
  for (MarkedPoint& p : start) p.at = window.draw(random);
  Arrangement state(window, start);
  for (int round = 0; round < kRounds; ++round) {
    for (int k = 0; k < kSweepsOfRound; ++k) state.sweep(process, wanted, random);
    approach(window, wanted, where, state, round < kRounds - kAveraged ? 0.3 : 0.1, process);
    if (round >= kRounds - kAveraged) add(process, 1.0 / kAveraged, mean);
  }
  const PairSteps even = even_pairs(window, points, mix64(seed));
  for (size_t k = 0; k < even.values.size(); ++k) {
    mean.correlation.values[k] = wanted.values[k] / std::max(even.values[k], kLeastEven);
  }
  return mean;
}

void draw_places(const PointProcess& process, const Window& window, std::span<MarkedPoint> points,
                 uint64_t seed, size_t sweeps) {
  if (points.empty()) return;
  require(!window.is_empty(), "there is no ground for the objects of a site");
  PairSteps wanted = even_pairs(window, points, mix64(seed));
  for (size_t k = 0; k < wanted.values.size(); ++k) {
    wanted.values[k] = process.correlation.values[k] * std::max(wanted.values[k], kLeastEven);
  }
  Stream random(seed);
  for (MarkedPoint& p : points) p.at = window.draw(random);
  Arrangement state(window, points);
  for (size_t k = 0; k < sweeps; ++k) state.sweep(process, wanted, random);
  std::copy(state.points().begin(), state.points().end(), points.begin());
}

}  // namespace underbrush::sites
