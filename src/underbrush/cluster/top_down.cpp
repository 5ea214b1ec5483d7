#include "underbrush/cluster/top_down.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/linear.hpp"

namespace underbrush::cluster {
namespace {

/// A point (x, y, z, 1) relative to the first one. Clusters are ranges of such points.
using Point = Eigen::Vector4f;

/// The mean of a cluster and its greatest extent, which is floored.
struct Gaussian {
  Vec3f mean;
  Vec3f axis;  // direction of the greatest extent
  double largest_sigma;
};

class TopDownSplitter {
 public:
  TopDownSplitter(std::span<const Vec3f> points, const TopDownOptions& options)
      : points_(points.size()),
        index_(points.size()),
        least_(uint32_t(options.min_points)),
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
    if (n < 2 || n < 2 * least_) return end;
    const uint32_t middle = two_means(gaussian(begin, end), begin, end);
    return middle - begin < least_ || end - middle < least_ ? end : middle;
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
    const auto [variances, axes] = quick_spectrum(scatter / std::max(1.0, n - 1));
    const double largest = std::max(variances[2], options_.noise_m * options_.noise_m);
    Gaussian g;
    g.mean = (about.head<3>().cast<double>() + mean).cast<float>();
    g.axis = axes.col(2).cast<float>();
    g.largest_sigma = std::sqrt(largest);
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

  std::vector<Point> points_;
  std::vector<uint32_t> index_;  // original indices of the points
  const uint32_t least_;
  const TopDownOptions& options_;
  std::vector<float> along_;
  std::vector<Point> upper_;
  std::vector<uint32_t> upper_index_;
};

}  // namespace

Clusters top_down_clusters(std::span<const Vec3f> points, const TopDownOptions& options) {
  require(options.min_points >= 1, "top_down: min_points must be at least 1");
  require(options.noise_m > 0, "top_down: the noise must be positive");
  Clusters out;
  out.group.assign(points.size(), Clusters::kNone);
  if (points.empty()) return out;
  TopDownSplitter splitter(points, options);
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
