/// \file
/// From groups of points to ellipsoids: the part that all clusterings share.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush {
/// From logs to models.
namespace fit {

/// Clusters of points: `group[i]` is the cluster of point i, in [0, count), or `kNone` for a point
/// whose cluster would have too few.
struct Clusters {
  std::vector<uint32_t> group;
  uint32_t count = 0;
  static constexpr uint32_t kNone = 0xffffffffu;
};

/// Number of points and their first two moments, added up in double precision about a fixed point
/// near by.
struct PointMoments {
  double n = 0;
  Vec3 sum = Vec3::Zero();
  Mat3 squares = Mat3::Zero();  ///< Σ x xᵀ.

  void add(const Vec3& x);
  void add(const PointMoments& other);
  Vec3 mean() const { return sum / n; }
  /// Σ (x − mean)(x − mean)ᵀ.
  Mat3 scatter() const { return squares - sum * sum.transpose() / n; }
};

/// How a cluster becomes an ellipsoid.
struct EllipsoidOptions {
  double floor_m = 0.02;  ///< Least standard deviation in any direction: the sensor's range noise.
  /// Weight, in points, of a sphere with the mean log-volume of all clusters of the call that have
  /// at least 5 points: what few points do not say is taken from the rest. 0: none.
  double prior_points = 1;
};

/// The variance of a sphere with the mean log-volume of clusters that have at least 5 points.
class TypicalVariance {
 public:
  /// Every covariance is taken with `floor_m`² added.
  explicit TypicalVariance(double floor_m) : floor_(floor_m * floor_m) {}
  /// A cluster of n points with Σ (x − mean)(x − mean)ᵀ = `scatter`.
  void add(double n, const Mat3& scatter);
  /// m²; 0 without such clusters.
  double variance() const;

 private:
  double floor_, logs_ = 0, count_ = 0;
};

/// One ellipsoid a cluster, in order of cluster: μ is the mean, Σ = (scatter + ν σ² I) / (n − 1 +
/// ν) with ν = `prior_points` and σ² the variance of that sphere, then floored. ν = 0 gives the
/// sample moments. p_hit is left at 1.
std::vector<elements::Ellipsoid> ellipsoids_of(std::span<const Vec3f> points,
                                               const Clusters& clusters,
                                               const EllipsoidOptions& options);

/// Takes clusters with fewer than `min_points` points away and numbers the others anew, in order.
void drop_small(Clusters& clusters, int min_points);

}  // namespace fit
}  // namespace underbrush
