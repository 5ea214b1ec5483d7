#include "underbrush/metrics/instances.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <tuple>
#include <vector>

namespace underbrush::metrics {
namespace {

double share(size_t part, size_t whole) {
  return whole ? double(part) / double(whole) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

double InstanceScore::precision() const { return share(matched, found); }
double InstanceScore::recall() const { return share(matched, truth); }
double InstanceScore::f1() const { return share(2 * matched, found + truth); }

InstanceScore InstanceCounter::score(size_t min_points, double min_iou) const {
  std::map<uint32_t, size_t> found, truth;
  for (const auto& [pair, n] : points_) {
    found[pair.first] += n;
    truth[pair.second] += n;
  }
  const auto counts = [&](uint32_t number, const std::map<uint32_t, size_t>& of) {
    return number != 0 && of.at(number) >= min_points;
  };
  InstanceScore score;
  for (const auto& [number, n] : found) score.found += counts(number, found);
  for (const auto& [number, n] : truth) score.truth += counts(number, truth);
  std::vector<std::tuple<double, uint32_t, uint32_t>> pairs;
  for (const auto& [pair, n] : points_) {
    if (!counts(pair.first, found) || !counts(pair.second, truth)) continue;
    const double iou = share(n, found[pair.first] + truth[pair.second] - n);
    if (iou >= min_iou) pairs.emplace_back(-iou, pair.first, pair.second);
  }
  std::sort(pairs.begin(), pairs.end());  // the best pairs come first
  std::set<uint32_t> used_found, used_truth;
  for (const auto& [iou, f, t] : pairs) {
    if (used_found.count(f) || used_truth.count(t)) continue;
    used_found.insert(f), used_truth.insert(t);
    ++score.matched;
    score.mean_iou -= iou;
  }
  if (score.matched) score.mean_iou /= double(score.matched);
  return score;
}

}  // namespace underbrush::metrics
