#include "underbrush/cluster/top_down.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::cluster {
namespace {

/// A point (x, y, z, 1) relative to the first one. Clusters are ranges of such points.
using Point = Eigen::Vector4f;

/// The Gaussian of a cluster, with floored extents.
struct Gaussian {
  Vec3f mean;
  Vec3f axis;  // direction of the greatest extent
  Mat3f precision;
  double largest_sigma;
  float points;
};

constexpr float kOutliers = 0.01f;  // share of points that are outliers, spread evenly over 20 m

class TopDownSplitter {
 public:
  TopDownSplitter(std::span<const Vec3f> points, std::span<const Vec3f> to_sensor,
                  const TopDownOptions& options)
      : points_(points.size()),
        index_(points.size()),
        to_sensor_(to_sensor),
        least_(uint32_t(options.min_points)),
        by_likelihood_(options.stop == "range_likelihood"),
        options_(options) {
    for (uint32_t i = 0; i < points.size(); ++i) {
      points_[i] << points[i] - points[0], 1;
      index_[i] = i;
    }
  }

  /// Gives the original index of the point that now stands at `i`.
  uint32_t index(uint32_t i) const { return index_[i]; }

  /// Splits [begin, end) and gives the end of the first half, or `end` if the cluster stays whole.
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
  // Computes the Gaussian of [begin, end). Blocks of points are summed in four float lanes relative
  // to one point, and the blocks in double.
  Gaussian gaussian(uint32_t begin, uint32_t end) const {
    Point about = points_[begin];
    about[3] = 0;
    Eigen::Matrix4d total = Eigen::Matrix4d::Zero();
    for (uint32_t i = begin; i < end;) {
      Point sum[4] = {Point::Zero(), Point::Zero(), Point::Zero(), Point::Zero()};
      for (const uint32_t stop = std::min(end, i + 64); i < stop; ++i) {
        const Point x = points_[i] - about;
        sum[0] += x[0] * x;
        sum[1] += x[1] * x;
        sum[2] += x[2] * x;
        sum[3] += x;
      }
      for (int d = 0; d < 4; ++d) total.col(d) += sum[d].cast<double>();
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

  // Gives the number of projections at or above `border`, and the sum of what they exceed it by.
  std::pair<uint32_t, double> above(float border) const {
    uint32_t count = 0;
    for (const float a : along_) count += a >= border;
    double excess = 0;
    size_t i = 0;
    for (const size_t n = along_.size() / 4 * 4; i < n;) {
      Eigen::Array4f lanes = Eigen::Array4f::Zero();
      for (const size_t stop = std::min(n, i + 256); i < stop; i += 4) {
        lanes += (Eigen::Map<const Eigen::Array4f>(&along_[i]) - border).max(0.0f);
      }
      excess += double(lanes.sum());
    }
    for (; i < along_.size(); ++i) excess += std::max(along_[i] - border, 0.0f);
    return {count, excess};
  }

  // Runs Lloyd's iteration in one dimension and moves the points of the lower half to the front;
  // both halves keep their order. It has no branches on the data, because the processor could not
  // predict them.
  uint32_t two_means(const Gaussian& whole, uint32_t begin, uint32_t end) {
    const uint32_t n = end - begin;
    along_.resize(n);
    Point axis;
    axis << whole.axis, 0;
    const float offset = whole.axis.dot(whole.mean);
    for (uint32_t i = 0; i < n; ++i) along_[i] = axis.dot(points_[begin + i]) - offset;
    float border = 0;
    for (int iteration = 0; iteration < 4; ++iteration) {
      const auto [upper, excess] = above(border);
      if (upper == 0 || upper == n) break;
      const double sum = excess + upper * double(border);  // of the upper half; the total is 0
      const float next = float(0.5 * (sum / upper - sum / (n - upper)));
      if (std::abs(next - border) < 1e-3f * whole.largest_sigma) break;
      border = next;
    }
    if (upper_.size() < n) {
      upper_.resize(n);
      upper_index_.resize(n);
    }
    uint32_t lower = 0, upper = 0;
    for (uint32_t i = 0; i < n; ++i) {
      const Point point = points_[begin + i];
      const uint32_t index = index_[begin + i];
      const bool below = along_[i] < border;
      points_[begin + lower] = upper_[upper] = point;
      index_[begin + lower] = upper_index_[upper] = index;
      lower += below;
      upper += !below;
    }
    std::copy_n(upper_.begin(), upper, points_.begin() + begin + lower);
    std::copy_n(upper_index_.begin(), upper, index_.begin() + begin + lower);
    return begin + lower;
  }

  // Computes the density at the range of the beam that measured point i if the beam meets `g`, else
  // a negative number.
  float density(const Gaussian& g, uint32_t i) const {
    const Vec3f r = points_[i].head<3>() - g.mean;
    const Vec3f d = to_sensor_[index_[i]].normalized();
    const Vec3f q = g.precision * d;
    const float information = d.dot(q), t = q.dot(r) / information;
    const float along = t * t * information;
    const float delta2 = r.dot(g.precision * r) - along;
    if (delta2 > float(options_.tau * options_.tau)) return -1;
    return std::sqrt(information * float(0.5 / M_PI)) * std::exp(-0.5f * along);
  }

  double gain(const Gaussian& whole, uint32_t begin, uint32_t middle, uint32_t end) const {
    const Gaussian half[2] = {gaussian(begin, middle), gaussian(middle, end)};
    double gain = 0;
    for (uint32_t i = begin; i < end; ++i) {
      const float before = std::max(0.0f, density(whole, i));
      float weight = 0, after = 0;
      for (const Gaussian& h : half) {
        const float f = density(h, i);
        if (f < 0) continue;
        weight += h.points;
        after += h.points * f;
      }
      if (weight > 0) after /= weight;
      gain += std::log((kOutliers / 20 + (1 - kOutliers) * after) /
                       (kOutliers / 20 + (1 - kOutliers) * before));
    }
    return gain;
  }

  std::vector<Point> points_;
  std::vector<uint32_t> index_;  // original indices of the points
  const std::span<const Vec3f> to_sensor_;
  const uint32_t least_;
  const bool by_likelihood_;
  const TopDownOptions& options_;
  std::vector<float> along_;
  std::vector<Point> upper_;
  std::vector<uint32_t> upper_index_;
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
  TopDownSplitter splitter(points, to_sensor, options);
  std::vector<std::pair<uint32_t, uint32_t>> open{{0, uint32_t(points.size())}};
  while (!open.empty()) {
    const auto [begin, end] = open.back();
    open.pop_back();
    const uint32_t middle = splitter.split(begin, end);
    if (middle == end) {
      for (uint32_t i = begin; i < end; ++i) out.group[splitter.index(i)] = out.count;
      ++out.count;
    } else {
      open.emplace_back(middle, end);
      open.emplace_back(begin, middle);
    }
  }
  return out;
}

}  // namespace underbrush::cluster
