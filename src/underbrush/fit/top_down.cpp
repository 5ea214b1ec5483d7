#include "underbrush/fit/top_down.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::fit {
namespace {

/// A point with its number and the direction of its beam; ranges of them are the clusters.
struct Item {
  Vec3f x;
  uint32_t index;
  Vec3f to_sensor;
};

/// A cluster's Gaussian, its extents floored.
struct Gaussian {
  Vec3 mean;
  Vec3 axis;  // of the greatest extent
  Mat3f precision;
  Vec3f mean_f;
  double largest_sigma;
  float points;
};

constexpr float kLogTwoPi = 1.8378770664f;
constexpr float kOutlierDensity = 0.01f / 20;  // one in a hundred, anywhere within 20 m

class Splitter {
 public:
  Splitter(std::vector<Item>& items, const TopDownOptions& options)
      : items_(items),
        least_(uint32_t(options.min_points)),
        by_likelihood_(options.stop == "range_likelihood"),
        options_(options) {}

  /// End of the first half after a split of [begin, end); `end` if it stays whole.
  uint32_t split(uint32_t begin, uint32_t end) {
    const uint32_t n = end - begin;
    if (n < 2 || (!by_likelihood_ && n < 2 * least_)) return end;
    const Gaussian whole = gaussian(begin, end);
    const bool large = by_likelihood_ && whole.largest_sigma > options_.largest_sigma_m;
    if (!large && n < 2 * least_) return end;
    const uint32_t middle = two_means(whole, begin, end);
    if (middle == begin || large) return middle == begin ? end : middle;
    if (middle - begin < least_ || end - middle < least_) return end;
    return by_likelihood_ && gain(whole, begin, middle, end) < options_.least_gain ? end : middle;
  }

 private:
  Gaussian gaussian(uint32_t begin, uint32_t end) const {
    const Vec3 about = items_[begin].x.cast<double>();  // so that squares do not cancel
    Moments m;
    for (uint32_t i = begin; i < end; ++i) m.add(items_[i].x.cast<double>() - about);
    Eigen::SelfAdjointEigenSolver<Mat3> eigen;
    eigen.computeDirect(m.scatter() / std::max(1.0, m.n - 1));
    const Vec3 values = eigen.eigenvalues().cwiseMax(options_.noise_m * options_.noise_m);
    const Mat3& v = eigen.eigenvectors();
    Gaussian g;
    g.mean = about + m.mean();
    g.mean_f = g.mean.cast<float>();
    g.axis = v.col(2);
    g.precision = (v * values.cwiseInverse().asDiagonal() * v.transpose()).cast<float>();
    g.largest_sigma = std::sqrt(values[2]);
    g.points = float(m.n);
    return g;
  }

  // Lloyd's iteration in one dimension, then the items of the lower half moved to the front.
  uint32_t two_means(const Gaussian& whole, uint32_t begin, uint32_t end) {
    const Vec3f axis = whole.axis.cast<float>();
    const auto along = [&](const Item& p) { return axis.dot(p.x - whole.mean_f); };
    along_.resize(end - begin);
    for (uint32_t i = begin; i < end; ++i) along_[i - begin] = along(items_[i]);
    float border = 0;
    for (int iteration = 0; iteration < 4; ++iteration) {
      double sum[2] = {0, 0}, count[2] = {0, 0};
      for (const float a : along_) {
        const bool upper = a >= border;
        sum[upper] += a;
        count[upper] += 1;
      }
      if (count[0] == 0 || count[1] == 0) break;
      const float next = float(0.5 * (sum[0] / count[0] + sum[1] / count[1]));
      if (next == border) break;
      border = next;
    }
    const auto middle = std::partition(items_.begin() + begin, items_.begin() + end,
                                       [&](const Item& p) { return along(p) < border; });
    return uint32_t(middle - items_.begin());
  }

  // Log-density of the range of the beam that measured `p`, if it meets `g`; false if it does not.
  bool log_density(const Gaussian& g, const Item& p, float* out) const {
    const Vec3f r = p.x - g.mean_f;
    const Vec3f q = g.precision * p.to_sensor;
    const float information = p.to_sensor.dot(q), t = q.dot(r) / information;
    const float along = t * t * information;
    const float delta2 = r.dot(g.precision * r) - along;
    *out = 0.5f * (std::log(information) - kLogTwoPi - along);
    return delta2 <= float(options_.tau * options_.tau);
  }

  double gain(const Gaussian& whole, uint32_t begin, uint32_t middle, uint32_t end) const {
    const Gaussian half[2] = {gaussian(begin, middle), gaussian(middle, end)};
    double gain = 0;
    for (uint32_t i = begin; i < end; ++i) {
      float log_f;
      float before = kOutlierDensity, after = kOutlierDensity;
      if (log_density(whole, items_[i], &log_f)) before += 0.99f * std::exp(log_f);
      float weight = 0, density = 0;
      for (const Gaussian& h : half) {
        if (!log_density(h, items_[i], &log_f)) continue;
        weight += h.points;
        density += h.points * std::exp(log_f);
      }
      if (weight > 0) after += 0.99f * density / weight;
      gain += std::log(after / before);
    }
    return gain;
  }

  std::vector<Item>& items_;
  const uint32_t least_;
  const bool by_likelihood_;
  const TopDownOptions& options_;
  std::vector<float> along_;
};

}  // namespace

Clusters top_down_clusters(std::span<const Vec3f> points, std::span<const Vec3f> to_sensor,
                           const TopDownOptions& options) {
  require(options.stop == "points" || options.stop == "range_likelihood",
          "top_down: the stopping rules are points and range_likelihood");
  require(options.min_points >= 1, "top_down: min_points must be at least 1");
  require(options.noise_m > 0 && options.tau > 0, "top_down: noise and tau must be positive");
  require(options.stop == "points" || to_sensor.size() == points.size(),
          "top_down: points and directions differ in number");
  Clusters out;
  out.group.assign(points.size(), Clusters::kNone);
  if (points.empty()) return out;
  std::vector<Item> items(points.size());
  for (uint32_t i = 0; i < items.size(); ++i) {
    items[i] = {points[i], i, to_sensor.empty() ? Vec3f::Zero() : to_sensor[i]};
  }
  Splitter splitter(items, options);
  std::vector<std::pair<uint32_t, uint32_t>> open{{0, uint32_t(items.size())}};
  while (!open.empty()) {
    const auto [begin, end] = open.back();
    open.pop_back();
    const uint32_t middle = splitter.split(begin, end);
    if (middle == end) {
      for (uint32_t i = begin; i < end; ++i) out.group[items[i].index] = out.count;
      ++out.count;
    } else {
      open.emplace_back(middle, end);
      open.emplace_back(begin, middle);
    }
  }
  return out;
}

}  // namespace underbrush::fit
