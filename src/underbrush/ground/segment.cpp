#include "underbrush/ground/segment.hpp"

#include <cmath>
#include <string>

#include "underbrush/core/check.hpp"
#include "underbrush/core/kd_tree.inl"
#include "underbrush/core/linear.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::ground {
namespace {

/// The finite points of a tile, as nanoflann's data set.
struct Cloud {
  std::span<const Vec3f> points;
  std::vector<uint32_t> finite;
};

/// A coordinate of a finite point.
struct FiniteCoordinate {
  const Cloud* cloud;
  float operator()(size_t i, size_t axis) const {
    return cloud->points[cloud->finite[i]][Eigen::Index(axis)];
  }
};
using Tree = KdTree<FiniteCoordinate>;

/// Finds the at most `k` nearest neighbours of a point within a radius, the point itself included.
class Neighbours {
 public:
  Neighbours(const Cloud& cloud, int k, double radius_m)
      : cloud_(cloud), index_(k), distance2_(k), radius2_(float(radius_m * radius_m)) {}

  /// Finds the neighbours of `query`; `index(j)` refers to the cloud's points.
  void find(const Tree& tree, const Vec3f& query) {
    const size_t found =
        tree.nearest(query.data(), index_.size(), index_.data(), distance2_.data());
    size_ = 0;
    while (size_ < found && distance2_[size_] <= radius2_) ++size_;
  }
  size_t size() const { return size_; }
  uint32_t index(size_t j) const { return cloud_.finite[index_[j]]; }
  float distance2(size_t j) const { return distance2_[j]; }

 private:
  const Cloud& cloud_;
  std::vector<uint32_t> index_;
  std::vector<float> distance2_;
  float radius2_;
  size_t size_ = 0;
};

/// Calls `body(i, neighbours)` for each finite point; points that lie near each other follow each
/// other.
template <class Body>
void for_each_point(const Cloud& cloud, const Tree& tree, int k, double radius_m,
                    const Body& body) {
  parallel_for(cloud.finite.size(), 2048, [&](size_t begin, size_t end) {
    Neighbours neighbours(cloud, k, radius_m);
    for (size_t at = begin; at < end; ++at) {
      const uint32_t i = cloud.finite[tree.order()[at]];
      neighbours.find(tree, cloud.points[i]);
      body(i, neighbours);
    }
  });
}

float variance_of(std::span<const Vec3f> points, const Vec3f& at, const Neighbours& neighbours) {
  Vec3 sum = Vec3::Zero();
  Mat3 square = Mat3::Zero();
  for (size_t j = 0; j < neighbours.size(); ++j) {
    const Vec3 d = (points[neighbours.index(j)] - at).cast<double>();
    sum += d;
    square.selfadjointView<Eigen::Lower>().rankUpdate(d);
  }
  const double n = double(neighbours.size());
  Mat3 covariance = square.selfadjointView<Eigen::Lower>();
  covariance = (covariance - sum * sum.transpose() / n) / n;
  const double trace = covariance.trace();
  if (!(trace > 0)) return 0;
  return float(std::max(0.0, quick_eigenvalues(covariance / trace)[0]));
}

}  // namespace

std::vector<float> spherical_variances(std::span<const Vec3f> points,
                                       const SphericalVarianceOptions& o) {
  require(o.neighbours > 0 && o.radius_m > 0 && o.smooth_neighbours >= 0 && o.smooth_radius_m > 0 &&
              o.smooth_scale_m > 0,
          "spherical variance: numbers of neighbours and distances must be positive");
  std::vector<float> phi(points.size(), NAN);
  Cloud cloud{points, {}};
  for (size_t i = 0; i < points.size(); ++i) {
    if (points[i].allFinite()) cloud.finite.push_back(uint32_t(i));
  }
  if (cloud.finite.empty()) return phi;
  const Tree tree(cloud.finite.size(), {&cloud}, 16);
  for_each_point(cloud, tree, o.neighbours, o.radius_m, [&](uint32_t i, const Neighbours& near) {
    phi[i] = int(near.size()) < o.min_neighbours ? float(o.default_variance)
                                                 : variance_of(points, points[i], near);
  });
  if (o.smooth_neighbours == 0) return phi;
  std::vector<float> smooth(points.size(), NAN);
  const float scale = float(-1 / (o.smooth_scale_m * o.smooth_scale_m));
  for_each_point(cloud, tree, o.smooth_neighbours, o.smooth_radius_m,
                 [&](uint32_t i, const Neighbours& near) {
                   double sum = 0, weights = 0;
                   for (size_t j = 0; j < near.size(); ++j) {
                     const float w = std::exp(scale * near.distance2(j));
                     sum += double(w * phi[near.index(j)]);
                     weights += double(w);
                   }
                   smooth[i] = float(sum / weights);
                 });
  return smooth;
}

std::vector<uint8_t> spherical_variance(std::span<const Vec3f> points,
                                        const SphericalVarianceOptions& options) {
  const std::vector<float> phi = spherical_variances(points, options);
  std::vector<uint8_t> ground(points.size());
  for (size_t i = 0; i < phi.size(); ++i) ground[i] = double(phi[i]) < options.threshold;
  return ground;
}

std::vector<uint8_t> segment(std::span<const Vec3f> points, const SegmentOptions& options) {
  if (options.method == "lower_envelope") return lower_envelope(points, options.lower_envelope);
  if (options.method == "spherical_variance") {
    return spherical_variance(points, options.spherical_variance);
  }
  if (options.method == "none") return std::vector<uint8_t>(points.size());
  throw std::invalid_argument("no ground segmentation of the name '" + std::string(options.method) +
                              "'; there are lower_envelope, spherical_variance and none");
}

}  // namespace underbrush::ground
