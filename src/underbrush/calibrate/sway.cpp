#include "underbrush/calibrate/sway.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "underbrush/calibrate/repeats.hpp"
#include "underbrush/core/still_beams.hpp"
#include "underbrush/simulate/simulate.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::calibrate {
namespace {

constexpr int kRoundsOfTime = 4;
constexpr double kLeastExcess = 1.25;  // of the difference of still matter

BeamLog answered(const elements::Model& model, trace::Draws draws, const simulate::Options& options,
                 BeamLog beams) {
  simulate::simulate(trace::World(model, trace::Isa::kBest, draws), options, 0, beams);
  return beams;
}

/// Leaves out pairs with a beam that does not end on an ellipsoid; keyframes have no part in that.
void keep_on_ellipsoids(const elements::Model& model, uint64_t seed, const BeamLog& beams,
                        BeamPairs& pairs) {
  simulate::Options options;
  options.seed = seed;
  options.element_ids = true;
  const BeamLog still = answered(model, trace::Draws::kOnce, options, beams);
  const auto& element = std::get<std::vector<uint32_t>>(still.extra.at("element"));
  const auto on_ellipsoid = [&](size_t i) {
    return element[i] < model.size() && model.kind(element[i]) == elements::Kind::kEllipsoid;
  };
  std::erase_if(pairs, [&](const std::pair<size_t, size_t>& pair) {
    return !on_ellipsoid(pair.first) || !on_ellipsoid(pair.second);
  });
}

/// The geometric mean of |Δ range| + 1 mm of the pairs that both return, m; 0 where none does.
double difference(const BeamLog& beams, const BeamPairs& pairs) {
  double sum = 0;
  size_t count = 0;
  for (const auto& [i, j] : pairs) {
    if (!beams.is_hit(i) || !beams.is_hit(j)) continue;
    sum += std::log(std::abs(double(beams.range_m[i]) - double(beams.range_m[j])) + 1e-3);
    ++count;
  }
  return count > 0 ? std::exp(sum / double(count)) : 0;
}

double median_interval(const BeamLog& beams, const BeamPairs& pairs) {
  std::vector<double> interval;
  interval.reserve(pairs.size());
  for (const auto& [i, j] : pairs) interval.push_back(beams.time_s[j] - beams.time_s[i]);
  const auto middle = interval.begin() + std::ptrdiff_t(interval.size() / 2);
  std::nth_element(interval.begin(), middle, interval.end());
  return *middle;
}

}  // namespace

SwayReport learn_sway(elements::Model& model, BeamSource& log, uint64_t seed) {
  SwayReport report;
  model.sway_s = 0;
  if (model.ellipsoids.empty()) return report;
  StillBeams still(log);
  Repeats repeats = repeats_of(still, seed);
  report.stands = repeats.stands;
  if (!report.stands) return report;
  const BeamLog& beams = repeats.beams;
  BeamPairs& pairs = repeats.pairs;
  keep_on_ellipsoids(model, seed, beams, pairs);
  report.pairs = pairs.size();
  if (pairs.size() < kLeastPairs) return report;
  simulate::Options options;
  options.seed = seed;
  const auto of = [&](trace::Draws draws) {
    return difference(answered(model, draws, options, beams), pairs);
  };
  report.interval_s = median_interval(beams, pairs);
  report.real_m = difference(beams, pairs);
  report.still_m = of(trace::Draws::kOnce);
  report.anew_m = of(trace::Draws::kAnew);
  const double excess = report.real_m / report.still_m, most = report.anew_m / report.still_m;
  report.known = report.interval_s > 0 && report.still_m > 0 && most > 1;
  if (!report.known || excess <= kLeastExcess) return report;
  // A beam passes several cells, so the outcomes change faster than the matter of one of them.
  const double goal = std::min(1.0, std::log(excess) / std::log(most));
  options.sway_s = report.interval_s / goal;
  for (int k = 0; k < kRoundsOfTime; ++k) {
    const double share = std::log(of(trace::Draws::kSwaying) / report.still_m) / std::log(most);
    options.sway_s = std::max(report.interval_s, options.sway_s * share / goal);
  }
  model.sway_s = options.sway_s;
  return report;
}

}  // namespace underbrush::calibrate
