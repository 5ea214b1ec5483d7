#include "underbrush/radiometry/lone_echo.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>

#include "underbrush/core/clones.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/radiometry/normal_quantiles.hpp"

namespace underbrush::radiometry {
namespace {

constexpr int kPulses = 400;            // that are measured at a node
constexpr float kNodesPerOctave = 3;    // of the ratio
constexpr uint32_t kDraw = 0xFFFF2000;  // element of `Purpose::kSignal`

using Values = Eigen::Vector4d;

/// Measures the echoes of one signal; gives nothing if a pulse has none, or two.
std::optional<std::vector<Values>> measure(float signal, float from_m, float to_m,
                                           const LoneEcho::Detect& detect) {
  std::vector<Values> out;
  for (int k = 0; k < kPulses; ++k) {
    const float range = from_m + (to_m - from_m) * (float(k) + 0.5f) / float(kPulses);
    const Echoes found = detect(range, signal, mix64(uint64_t(k)));
    if (found.count != 1) return std::nullopt;
    const Echo& e = found.echo[0];
    const double of = double(signal);
    out.emplace_back(double(e.range_m) - double(range), double(e.width_m), double(e.peak) / of,
                     double(e.energy) / of);
  }
  return out;
}

/// The nearest and the farthest return, and sums over all of them.
struct Extent {
  float nearest, farthest, sum, moment;
};

/// Eight lanes, which every instruction set adds up in the same order.
typedef float Eight __attribute__((vector_size(32), aligned(4), may_alias));  // NOLINT
constexpr size_t kLanes = 8;

UNDERBRUSH_CLONES Extent extent_of(size_t n, const float* range_m, const float* signal,
                                   float max_range_m) {
  Eight nearest = Eight{} + std::numeric_limits<float>::infinity(), farthest{}, sum{}, moment{};
  const auto add = [&](const Eight& r, const Eight& a) {
    const auto counts = (a > 0.0f) & (r >= 0.0f) & (r <= max_range_m);
    const Eight weight = counts ? a : Eight{}, at = counts ? r : Eight{};
    nearest = counts & (r < nearest) ? r : nearest;
    farthest = at > farthest ? at : farthest;
    sum += weight;
    moment += weight * at;
  };
  size_t k = 0;
  for (; k + kLanes <= n; k += kLanes) {
    add(*reinterpret_cast<const Eight*>(range_m + k), *reinterpret_cast<const Eight*>(signal + k));
  }
  if (k < n) {
    float r[kLanes] = {}, a[kLanes] = {};
    std::copy(range_m + k, range_m + n, r);
    std::copy(signal + k, signal + n, a);
    add(*reinterpret_cast<const Eight*>(r), *reinterpret_cast<const Eight*>(a));
  }
  Extent e{nearest[0], farthest[0], sum[0], moment[0]};
  for (size_t i = 1; i < kLanes; ++i) {
    e.nearest = nearest[i] < e.nearest ? nearest[i] : e.nearest;
    e.farthest = farthest[i] > e.farthest ? farthest[i] : e.farthest;
    e.sum += sum[i];
    e.moment += moment[i];
  }
  return e;
}

}  // namespace

LoneReturn lone_return(std::span<const float> range_m, std::span<const float> signal,
                       float max_range_m, float apart_m) {
  if (range_m.size() == 1) {
    const bool counts = (signal[0] > 0) & (range_m[0] >= 0) & (range_m[0] <= max_range_m);
    return counts ? LoneReturn{range_m[0], signal[0]} : LoneReturn{};
  }
  const Extent e = extent_of(range_m.size(), range_m.data(), signal.data(), max_range_m);
  if (!(e.sum > 0) || e.farthest - e.nearest > apart_m) return {};
  return {std::clamp(e.moment / e.sum, e.nearest, e.farthest), e.sum};
}

LoneEcho::LoneEcho(double least, double most, double noise, float from_m, float to_m,
                   const Detect& detect) {
  if (!(most > least)) return;
  first_log2_ = float(std::log2(least));
  const int steps = std::max(1, int(std::ceil(std::log2(most / least) * double(kNodesPerOctave))));
  for (int n = 0; n <= steps; ++n) {
    const double ratio = least * std::exp2(n / double(kNodesPerOctave));
    const auto values = measure(float(std::min(ratio, most) * noise), from_m, to_m, detect);
    if (!values) {
      if (most_ > 0) return;  // the pulses are cut from here on
      continue;               // too weak to be found for sure
    }
    Values mean = Values::Zero();
    for (const Values& v : *values) mean += v / kPulses;
    Eigen::Matrix4d covariance = 1e-14 * Eigen::Matrix4d::Identity();
    for (const Values& v : *values) {
      covariance += (v - mean) * (v - mean).transpose() / kPulses;
    }
    const Eigen::Matrix4d root = covariance.llt().matrixL();
    if (nodes_.empty()) {
      least_ = float(ratio);
      first_log2_ = float(std::log2(ratio));
    }
    most_ = float(std::min(ratio, most));
    Moments m{};
    for (size_t i = 0, k = 0; i < kValues; ++i) {
      m.mean[i] = float(mean[long(i)]);
      for (size_t j = 0; j <= i; ++j) m.root[k++] = float(root(long(i), long(j)));
    }
    nodes_.push_back(m);
  }
}

Echo LoneEcho::draw(const LoneReturn& of, float ratio, uint64_t key) const {
  const auto& normal = normal_quantiles();
  const float at = (std::log2(ratio) - first_log2_) * kNodesPerOctave;
  const size_t node = std::min(size_t(std::max(at, 0.0f)), nodes_.size() - 1);
  const Moments &a = nodes_[node], &b = nodes_[std::min(node + 1, nodes_.size() - 1)];
  const float part = std::clamp(at - float(node), 0.0f, 1.0f);
  const uint64_t bits = random_bits(key, kDraw, Purpose::kSignal);
  float z[kValues], value[kValues];
  for (size_t k = 0; k < kValues; ++k) z[k] = normal[bits >> (16 * k) & 4095];
  for (size_t i = 0, k = 0; i < kValues; ++i) {
    value[i] = a.mean[i] + part * (b.mean[i] - a.mean[i]);
    for (size_t j = 0; j <= i; ++j, ++k) {
      value[i] += (a.root[k] + part * (b.root[k] - a.root[k])) * z[j];
    }
  }
  Echo e;
  e.range_m = of.range_m + value[0];
  e.width_m = std::max(value[1], 0.0f);
  e.peak = of.signal * value[2];
  e.energy = of.signal * value[3];
  return e;
}

}  // namespace underbrush::radiometry
