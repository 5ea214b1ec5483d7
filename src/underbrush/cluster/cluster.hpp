/// \file
/// This file turns clusters of points into ellipsoids, which is the step that all clusterings
/// share.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush {
/// Clusterings of points, and the ellipsoids of clusters.
namespace cluster {

/// A partition of points: `group[i]` is the cluster of point i, in [0, count), or `kNone` for a
/// point in no cluster, because its cluster would have too few points.
struct Clusters {
  std::vector<uint32_t> group;
  uint32_t count = 0;
  static constexpr uint32_t kNone = 0xffffffffu;
};

/// The number of points and their first two moments. Sums are in double precision and relative to a
/// fixed point nearby, which keeps rounding small.
struct PointMoments {
  double n = 0;
  Vec3 sum = Vec3::Zero();      ///< Σ x.
  Mat3 squares = Mat3::Zero();  ///< Σ x xᵀ.

  void add(const Vec3& x);
  void add(const PointMoments& other);
  Vec3 mean() const { return sum / n; }
  /// The scatter matrix Σ (x − mean)(x − mean)ᵀ.
  Mat3 scatter() const { return squares - sum * sum.transpose() / n; }
};

/// Options for turning a cluster into an ellipsoid.
struct EllipsoidOptions {
  /// Least standard deviation of an ellipsoid of few points in any direction, m: the sensor's range
  /// noise.
  double floor_m = 0.02;
  /// Weight of the prior covariance, in points; 0 uses none. The prior is a sphere of the usual
  /// size: its log-volume is the mean over all clusters of the call with at least 5 points.
  double prior_points = 1;

  /// Least standard deviation of an ellipsoid of n points, m: `floor_m` for 10 points or fewer,
  /// which hardly show how thin matter is. It falls as 1/√n, to `least_m`.
  double floor_of(double n) const;
  /// Least standard deviation of an ellipsoid of many points, m: a quarter of `floor_m`.
  double least_m() const { return 0.25 * floor_m; }
};

/// An average of covariances: the variance of a sphere whose log-volume is the mean over clusters
/// with at least 5 points.
class TypicalVariance {
 public:
  /// Starts without clusters. `floor_m`² (m²) is added to every variance.
  explicit TypicalVariance(double floor_m) : floor_(floor_m * floor_m) {}
  /// Adds a cluster of n points with the scatter matrix Σ (x − mean)(x − mean)ᵀ (m²).
  void add(double n, const Mat3& scatter);
  /// The variance of the sphere, m²; 0 where no cluster has 5 points.
  double variance() const;

 private:
  double floor_, logs_ = 0, count_ = 0;
};

/// Makes one ellipsoid for each cluster, in the order of the clusters. μ is the mean and Σ =
/// (scatter + ν σ² I) / (n − 1 + ν), with ν = `prior_points` and σ² the `TypicalVariance` of all
/// clusters; then `floor_of` is applied. ν = 0 gives the sample moments. `points` are in metres;
/// p_hit is left at 1.
std::vector<elements::Ellipsoid> ellipsoids_of(std::span<const Vec3f> points,
                                               const Clusters& clusters,
                                               const EllipsoidOptions& options);

/// Removes clusters with fewer than `min_points` points and renumbers the others in their order.
void drop_small(Clusters& clusters, int min_points);

}  // namespace cluster
}  // namespace underbrush
