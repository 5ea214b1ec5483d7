#include "underbrush/fit/top_down.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::fit {
namespace {

/// A point with its number; ranges of them are the clusters.
struct Item {
  Vec3f x;
  uint32_t index;
};

/// A cluster's Gaussian, its extents floored.
struct Gaussian {
  Vec3f mean;
  Vec3f axis;  // of the greatest extent
  Mat3f precision;
  double largest_sigma;
  float points;
};

constexpr float kLogTwoPi = 1.8378770664f;
constexpr float kOutlierDensity = 0.01f / 20;  // one in a hundred, anywhere within 20 m

class Splitter {
 public:
  Splitter(std::vector<Item>& items, std::span<const Vec3f> to_sensor,
           const TopDownOptions& options)
      : items_(items),
        to_sensor_(to_sensor),
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
  // Mean and scatter of [begin, end): sums of few points in four float lanes about one of them,
  // those in double.
  Gaussian gaussian(uint32_t begin, uint32_t end) const {
    const Eigen::Vector4f about(items_[begin].x.x(), items_[begin].x.y(), items_[begin].x.z(), -1);
    Eigen::Matrix4d total = Eigen::Matrix4d::Zero();
    for (uint32_t i = begin; i < end;) {
      Eigen::Matrix4f sum = Eigen::Matrix4f::Zero();
      for (const uint32_t stop = std::min(end, i + 64); i < stop; ++i) {
        const Vec3f& p = items_[i].x;
        const Eigen::Vector4f x = Eigen::Vector4f(p.x(), p.y(), p.z(), 0) - about;  // last: 1
        for (int d = 0; d < 4; ++d) sum.col(d) += x[d] * x;
      }
      total += sum.cast<double>();
    }
    const double n = total(3, 3);
    const Vec3 mean = total.topRightCorner<3, 1>() / n;
    const Mat3 scatter = total.topLeftCorner<3, 3>() - n * mean * mean.transpose();
    Eigen::SelfAdjointEigenSolver<Mat3> eigen;
    eigen.computeDirect(scatter / std::max(1.0, n - 1));
    const Vec3 values = eigen.eigenvalues().cwiseMax(options_.noise_m * options_.noise_m);
    const Mat3& v = eigen.eigenvectors();
    Gaussian g;
    g.mean = (about.head<3>().cast<double>() + mean).cast<float>();
    g.axis = v.col(2).cast<float>();
    g.precision = (v * values.cwiseInverse().asDiagonal() * v.transpose()).cast<float>();
    g.largest_sigma = std::sqrt(values[2]);
    g.points = float(n);
    return g;
  }

  // Lloyd's iteration in one dimension, then the items of the lower half moved to the front, both
  // halves in their order. Without branches, which nothing could predict.
  uint32_t two_means(const Gaussian& whole, uint32_t begin, uint32_t end) {
    const uint32_t n = end - begin;
    along_.resize(n);
    for (uint32_t i = 0; i < n; ++i) along_[i] = whole.axis.dot(items_[begin + i].x - whole.mean);
    float border = 0;
    for (int iteration = 0; iteration < 4; ++iteration) {
      double sum = 0, upper_sum = 0;
      uint32_t upper = 0;
      for (const float a : along_) {
        const bool above = a >= border;
        upper += above;
        upper_sum += above ? a : 0;
        sum += a;
      }
      if (upper == 0 || upper == n) break;
      const float next = float(0.5 * (upper_sum / upper + (sum - upper_sum) / (n - upper)));
      if (next == border) break;
      border = next;
    }
    scratch_.resize(n);
    uint32_t lower = 0, upper = 0;
    for (uint32_t i = 0; i < n; ++i) {
      const Item item = items_[begin + i];
      const bool below = along_[i] < border;
      items_[begin + lower] = item;
      scratch_[upper] = item;
      lower += below;
      upper += !below;
    }
    std::copy_n(scratch_.begin(), upper, items_.begin() + begin + lower);
    return begin + lower;
  }

  // Log-density of the range of the beam that measured `p`, if it meets `g`; false if it does not.
  bool log_density(const Gaussian& g, const Item& p, float* out) const {
    const Vec3f r = p.x - g.mean;
    const Vec3f& d = to_sensor_[p.index];
    const Vec3f q = g.precision * d;
    const float information = d.dot(q), t = q.dot(r) / information;
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
  const std::span<const Vec3f> to_sensor_;
  const uint32_t least_;
  const bool by_likelihood_;
  const TopDownOptions& options_;
  std::vector<float> along_;
  std::vector<Item> scratch_;
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
    items[i] = {points[i], i};
  }
  Splitter splitter(items, to_sensor, options);
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
