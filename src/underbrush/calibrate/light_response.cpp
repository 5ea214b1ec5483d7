#include "underbrush/calibrate/light_response.hpp"

#include <algorithm>
#include <cmath>

namespace underbrush::calibrate {
namespace {

using elements::Gain;
using elements::Light;
using elements::Reflectance;

constexpr double kPriorReturns = 20;       // of a knot, at the gain 1
constexpr double kPriorSpreadReturns = 8;  // of an element's variance
constexpr double kMostRatio = 4;
constexpr double kSettledGain = 5e-3;  // largest relative change of a gain in the last round
constexpr int kRounds = 40, kPooledRounds = 4;
constexpr size_t kMostRings = 1024, kLeastElements = 20;

/// What the elements of a group have in common.
struct Group {
  double mean = 0, within = 0, between = 0;  // m, s², τ²
  double lambda = 0;
  double variance = 0;  // of I/k within an element
};

/// Sums over the elements of a group.
struct GroupSums {
  double k = 0, kk = 0, intensity = 0, residual = 0, freedom = 0, elements = 0, scatter = 0;

  void add(const LightSums& s) {
    k += s.response;
    kk += s.response * s.response;
    intensity += s.intensity;
    residual += s.squares - s.intensity * s.intensity / s.response;
    freedom += s.returns - 1;
    elements += 1;
  }
  double mean() const { return intensity / k; }
  void add_scatter(const LightSums& s) {
    const double off = s.intensity / s.response - mean();
    scatter += s.response * off * off;
  }
};

/// The moments of [buhlmann70].
Group moments(const GroupSums& s) {
  Group g;
  if (s.k == 0) return g;
  g.mean = s.mean();
  if (s.freedom > 0) g.within = std::max(0.0, s.residual / s.freedom);
  g.variance = std::max(0.0, s.residual / s.k);
  if (s.elements < kLeastElements || s.freedom == 0) return g;
  g.between = (s.scatter - (s.elements - 1) * g.within) / (s.k - s.kk / s.k);
  if (g.between > 0) g.lambda = g.within / g.between;
  return g;
}

/// The groups, of which those with too little data take over what all elements have.
std::vector<Group> groups_of(std::span<const LightSums> sums, std::span<const uint32_t> group,
                             size_t groups) {
  std::vector<GroupSums> of(groups);
  GroupSums together;
  for (const bool scatter : {false, true}) {
    for (size_t e = 0; e < sums.size(); ++e) {
      if (sums[e].returns == 0) continue;
      for (GroupSums* s : {&together, &of[group[e]]}) {
        scatter ? s->add_scatter(sums[e]) : s->add(sums[e]);
      }
    }
  }
  const Group all = moments(together);
  std::vector<Group> out;
  for (const GroupSums& s : of) {
    Group& g = out.emplace_back(moments(s));
    if (!(g.between > 0)) {
      g.lambda = all.between > 0 ? all.lambda : kPriorReturns;
      if (g.mean == 0) g.mean = all.mean;
      if (g.variance == 0) g.variance = all.variance;
    }
  }
  return out;
}

Gain flat(std::vector<double> knots) {
  std::vector<double> ones(knots.size(), 1.0);
  return {std::move(knots), std::move(ones)};
}

std::vector<double> range_knots() {
  std::vector<double> at;
  for (int k = 0; k <= 17; ++k) at.push_back(std::pow(2.0, 0.5 * k));  // 1 to 362 m
  return at;
}

/// Returns of a log with the response so far.
class Regression {
 public:
  Regression(std::span<const LightSample> samples, std::span<const uint32_t> group, size_t groups)
      : samples_(samples),
        group_(group),
        groups_(groups),
        places_(samples.size()),
        of_range_(samples.size()),
        of_cosine_(samples.size()) {
    light_.range = flat(range_knots());
    for (Gain& g : light_.incidence) g = flat({0, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1});
    size_t rings = 0;
    double sum = 0;
    for (size_t i = 0; i < samples.size(); ++i) {
      const LightSample& s = samples[i];
      rings = std::max(rings, size_t(s.ring) + 1);
      sum += s.intensity;
      places_[i] = {light_.range.between(s.range_m), light_.incidence[0].between(s.cosine)};
      of_range_[i] = value(light_.range, places_[i].range);
      of_cosine_[i] = value(light_.incidence[s.is_ellipsoid], places_[i].cosine);
    }
    if (rings > 1 && rings <= kMostRings) light_.ring.assign(rings, 1.0);
    prior_ = kPriorReturns * sum / double(std::max<size_t>(1, samples.size()));
  }

  Light fit() {
    for (int round = 0; round < kRounds; ++round) {
      const std::vector<double> before = gains();
      update_elements(round < kPooledRounds);
      update(
          light_.range, of_range_, [](const LightSample&) { return true; },
          [](const Places& p) -> const Gain::Between& { return p.range; });
      for (const bool ellipsoid : {false, true}) {
        update(
            light_.incidence[ellipsoid], of_cosine_,
            [&](const LightSample& s) { return s.is_ellipsoid == ellipsoid; },
            [](const Places& p) -> const Gain::Between& { return p.cosine; });
      }
      update_rings();
      if (round >= kPooledRounds && largest_change(before, gains()) < kSettledGain) break;
    }
    drop_unseen();
    return std::move(light_);
  }

 private:
  struct Places {
    Gain::Between range, cosine;
  };

  /// The gains of all knots and rings.
  std::vector<double> gains() const {
    std::vector<double> all = light_.ring;
    for (const Gain* g : {&light_.range, &light_.incidence[0], &light_.incidence[1]}) {
      all.insert(all.end(), g->gain.begin(), g->gain.end());
    }
    return all;
  }
  static double largest_change(const std::vector<double>& from, const std::vector<double>& to) {
    double most = 0;
    for (size_t k = 0; k < from.size(); ++k) {
      most = std::max(most, std::abs(to[k] - from[k]) / from[k]);
    }
    return most;
  }
  static double value(const Gain& g, const Gain::Between& at) {
    return (1 - at.weight) * g.gain[at.first] + at.weight * g.gain[at.second];
  }
  double response(size_t i) const {
    const LightSample& s = samples_[i];
    const double h = light_.ring.empty() ? 1 : light_.ring[s.ring];
    return of_range_[i] * of_cosine_[i] * h;
  }
  static double ratio(double intensity, double predicted) {
    return predicted > 0 ? std::min(intensity / predicted, kMostRatio) : 1;
  }

  void update_elements(bool pooled) {
    std::vector<LightSums> sums(group_.size());
    for (size_t i = 0; i < samples_.size(); ++i) {
      sums[samples_[i].element].add(samples_[i].intensity, response(i));
    }
    reflectance_ = reflectances(sums, group_, groups_, pooled);
  }

  /// Updates a gain, which has `values` at the places of the samples.
  template <class IsOf, class PlaceOf>
  void update(Gain& g, std::vector<double>& values, IsOf is_of, PlaceOf place_of) {
    std::vector<double> seen(g.gain.size(), prior_), expected(g.gain.size(), prior_);
    for (size_t i = 0; i < samples_.size(); ++i) {
      const LightSample& s = samples_[i];
      if (!is_of(s)) continue;
      const Gain::Between& at = place_of(places_[i]);
      const double predicted = double(reflectance_[s.element].mean) * response(i);
      const double others = predicted / values[i], r = ratio(s.intensity, predicted);
      const auto add = [&](size_t knot, double weight) {
        seen[knot] += others * weight * g.gain[knot] * r;
        expected[knot] += others * weight;
      };
      add(at.first, 1 - at.weight);
      add(at.second, at.weight);
    }
    for (size_t k = 0; k < g.gain.size(); ++k) g.gain[k] = std::max(seen[k] / expected[k], 1e-6);
    // The mean over the samples becomes one.
    double sum = 0, n = 0;
    for (size_t i = 0; i < samples_.size(); ++i) {
      if (!is_of(samples_[i])) continue;
      sum += value(g, place_of(places_[i]));
      n += 1;
    }
    if (n == 0) return;
    for (double& x : g.gain) x /= sum / n;
    for (size_t i = 0; i < samples_.size(); ++i) {
      if (is_of(samples_[i])) values[i] = value(g, place_of(places_[i]));
    }
  }

  void update_rings() {
    std::vector<double>& h = light_.ring;
    if (h.empty()) return;
    std::vector<double> seen(h.size(), prior_), expected(h.size(), prior_), count(h.size());
    for (size_t i = 0; i < samples_.size(); ++i) {
      const LightSample& s = samples_[i];
      const double predicted = double(reflectance_[s.element].mean) * response(i);
      seen[s.ring] += predicted * ratio(s.intensity, predicted);
      expected[s.ring] += predicted / h[s.ring];
      count[s.ring] += 1;
    }
    double sum = 0;
    for (size_t n = 0; n < h.size(); ++n) {
      h[n] = std::max(seen[n] / expected[n], 1e-6);
      sum += count[n] * h[n];
    }
    for (double& x : h) x /= sum / double(samples_.size());
  }

  /// Drops the knots of the range below and above all returns.
  void drop_unseen() {
    size_t first = light_.range.at.size(), last = 0;
    for (const Places& p : places_) {
      first = std::min(first, p.range.first);
      last = std::max(last, p.range.second);
    }
    if (first > last) return;
    for (std::vector<double>* x : {&light_.range.at, &light_.range.gain}) {
      *x = std::vector<double>(x->begin() + std::ptrdiff_t(first),
                               x->begin() + std::ptrdiff_t(last) + 1);
    }
  }

  std::span<const LightSample> samples_;
  std::span<const uint32_t> group_;
  size_t groups_;
  std::vector<Places> places_;                // of the samples between knots
  std::vector<double> of_range_, of_cosine_;  // gains of the samples
  Light light_;
  std::vector<Reflectance> reflectance_;
  double prior_ = 0;
};

}  // namespace

void LightSums::add(double intensity_of_one, double response_of_one) {
  response += response_of_one;
  intensity += intensity_of_one;
  squares += intensity_of_one * intensity_of_one / response_of_one;
  ++returns;
}

std::vector<Reflectance> reflectances(std::span<const LightSums> sums,
                                      std::span<const uint32_t> group, size_t groups, bool pooled) {
  const std::vector<Group> known = groups_of(sums, group, groups);
  std::vector<Reflectance> out(sums.size());
  for (size_t e = 0; e < sums.size(); ++e) {
    const LightSums& s = sums[e];
    const Group& g = known[group[e]];
    const double mean =
        pooled ? g.mean : (s.intensity + g.lambda * g.mean) / (s.response + g.lambda);
    // Σ k (I/k − ρ)² about the estimate.
    const double about = s.squares - 2 * mean * s.intensity + mean * mean * s.response;
    const double variance = (std::max(0.0, about) + kPriorSpreadReturns * g.variance) /
                            (s.response + kPriorSpreadReturns);
    out[e] = {float(mean), float(std::sqrt(variance))};
  }
  return out;
}

Light fit_response(std::span<const LightSample> samples, std::span<const uint32_t> group,
                   size_t groups) {
  // The few elements that have samples are numbered anew, in their order.
  constexpr uint32_t kUnseen = UINT32_MAX;
  std::vector<uint32_t> number(group.size(), kUnseen), own_group;
  for (const LightSample& s : samples) number[s.element] = 0;
  for (size_t e = 0; e < number.size(); ++e) {
    if (number[e] == kUnseen) continue;
    number[e] = uint32_t(own_group.size());
    own_group.push_back(group[e]);
  }
  std::vector<LightSample> own(samples.begin(), samples.end());
  for (LightSample& s : own) s.element = number[s.element];
  return Regression(own, own_group, groups).fit();
}

}  // namespace underbrush::calibrate
