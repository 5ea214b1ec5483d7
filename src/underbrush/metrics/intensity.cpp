#include "underbrush/metrics/intensity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "underbrush/credit/explaining.hpp"
#include "underbrush/elements/element_light.hpp"

namespace underbrush::metrics {
namespace {

constexpr uint8_t kNoBin = 255;
const std::vector<double> kIncidenceEdgesDeg = {0, 30, 60, 75, 85};

uint8_t bin_of(const std::vector<double>& edges, double x) {
  const auto above = std::upper_bound(edges.begin(), edges.end(), x);
  return above == edges.begin() ? kNoBin : uint8_t(above - edges.begin() - 1);
}

/// IntensitySums over predictions y of intensities x.
struct IntensitySums {
  double n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0, squared = 0, absolute = 0;

  void add(double real, double predicted) {
    n += 1;
    x += real;
    y += predicted;
    xx += real * real;
    yy += predicted * predicted;
    xy += real * predicted;
    squared += (predicted - real) * (predicted - real);
    absolute += std::abs(predicted - real);
  }
  double x_sd() const { return std::sqrt(std::max(0.0, xx / n - x / n * (x / n))); }
  double y_sd() const { return std::sqrt(std::max(0.0, yy / n - y / n * (y / n))); }
  IntensityErrors errors() const {
    IntensityErrors e;
    e.beams = size_t(n);
    if (n == 0) return e;
    e.rmse = std::sqrt(squared / n);
    e.mae = absolute / n;
    const double spread = x_sd() * y_sd();
    // Rounding leaves a constant a little spread.
    if (x_sd() > 1e-7 * std::abs(x / n) && y_sd() > 1e-7 * std::abs(y / n)) {
      e.correlation = (xy / n - x / n * (y / n)) / spread;
    }
    return e;
  }
};

/// The sums of the pairs for which `is_in` holds, with the prediction of `predict`.
template <class Pairs, class IsIn, class Predict>
IntensitySums sums_of(const Pairs& pairs, IsIn is_in, Predict predict) {
  IntensitySums sums;
  for (const auto& p : pairs) {
    if (is_in(p)) sums.add(p.real, predict(p));
  }
  return sums;
}

template <class Pairs, class BinOf>
std::map<std::string, IntensityErrors> by_bin(const Pairs& pairs, const std::vector<double>& edges,
                                              BinOf bin_of_pair) {
  std::map<std::string, IntensityErrors> out;
  for (size_t k = 0; k < edges.size(); ++k) {
    const IntensitySums sums = sums_of(
        pairs, [&](const auto& p) { return bin_of_pair(p) == k; },
        [](const auto& p) { return p.simulated; });
    if (sums.n > 0) out[bin_name(edges, k)] = sums.errors();
  }
  return out;
}

template <class Pairs>
double wasserstein_of(const Pairs& pairs) {
  std::vector<float> real, simulated;
  for (const auto& p : pairs) {
    real.push_back(p.real);
    simulated.push_back(p.simulated);
  }
  std::sort(real.begin(), real.end());
  std::sort(simulated.begin(), simulated.end());
  double sum = 0;
  for (size_t i = 0; i < real.size(); ++i) sum += std::abs(double(real[i]) - double(simulated[i]));
  return sum / double(real.size());
}

}  // namespace

std::string bin_name(const std::vector<double>& edges, size_t k) {
  const std::string from = std::to_string(int(edges[k])) + "-";
  return k + 1 < edges.size() ? from + std::to_string(int(edges[k + 1])) : from;
}

void IntensityScorer::add(const BeamLog& real, const BeamLog& simulated) {
  const auto classes = real.extra.find("class");
  has_classes_ = classes != real.extra.end();
  std::vector<uint32_t> element;
  if (model_) element = credit::explaining_elements(*model_, real);
  for (size_t i = 0; i < real.size(); ++i) {
    if (!real.is_hit(i) || !simulated.is_hit(i) || (real.flags[i] & kMover)) continue;
    Pair p{real.intensity[i], simulated.intensity[i], bin_of(range_edges_m_, real.range_m[i]),
           kNoBin, 0};
    if (model_ && element[i] != trace::Intersection::kNone) {
      const elements::Model& model = model_->model();
      const double c = elements::incidence_cosine(model, element[i], real.ray(i).direction);
      p.incidence_bin = bin_of(kIncidenceEdgesDeg, std::acos(c) * 180 / std::numbers::pi);
      p.group = 1 + uint32_t(model.kind(element[i]));
    }
    if (has_classes_) p.group = whole_number(classes->second, i);
    pairs_.push_back(p);
  }
}

std::optional<IntensityScore> IntensityScorer::finish(std::string& why) const {
  const auto all = [](const Pair&) { return true; };
  const auto any = [&](float Pair::*of) {
    return std::any_of(pairs_.begin(), pairs_.end(), [&](const Pair& p) { return p.*of != 0; });
  };
  why = pairs_.empty()           ? "no beam returns in both logs"
        : !any(&Pair::real)      ? "the real log has no intensities"
        : !any(&Pair::simulated) ? "the simulated log has no intensities"
                                 : "";
  if (!why.empty()) return std::nullopt;
  IntensityScore s;
  const IntensitySums sums = sums_of(pairs_, all, [](const Pair& p) { return p.simulated; });
  s.simulated = sums.errors();
  s.real_mean = sums.x / sums.n;
  s.real_sd = sums.x_sd();
  s.simulated_mean = sums.y / sums.n;
  s.simulated_sd = sums.y_sd();
  s.constant = sums_of(pairs_, all, [&](const Pair&) { return s.real_mean; }).errors();
  s.groups = has_classes_ ? "class" : model_ ? "kind" : "";
  if (!s.groups.empty()) {
    std::map<uint32_t, IntensitySums> group;
    for (const Pair& p : pairs_) group[p.group].add(p.real, 0);
    s.group_constant = sums_of(pairs_, all, [&](const Pair& p) {
                         const IntensitySums& of = group.at(p.group);
                         return of.x / of.n;
                       }).errors();
  }
  s.wasserstein = wasserstein_of(pairs_);
  s.per_range = by_bin(pairs_, range_edges_m_, [](const Pair& p) { return p.range_bin; });
  if (model_) {
    s.per_incidence =
        by_bin(pairs_, kIncidenceEdgesDeg, [](const Pair& p) { return p.incidence_bin; });
  }
  return s;
}

}  // namespace underbrush::metrics
