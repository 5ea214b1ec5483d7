#include "underbrush/fit/cluster.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::fit {
namespace {

struct Cluster {
  uint32_t n = 0;
  Vec3 mean = Vec3::Zero();
  Mat3 scatter = Mat3::Zero();
};

// The variance of a sphere with the mean log-volume of the ellipsoids of enough points.
double typical_variance(const std::vector<Cluster>& clusters, double floor_m) {
  constexpr uint32_t kEnough = 5;
  double logs = 0, count = 0;
  for (const Cluster& c : clusters) {
    if (c.n < kEnough) continue;
    const Mat3 sigma = c.scatter / (c.n - 1) + floor_m * floor_m * Mat3::Identity();
    logs += std::log(sigma.determinant()) / 3;
    count += 1;
  }
  return count > 0 ? std::exp(logs / count) : 0;
}

}  // namespace

void Moments::add(const Vec3& x) {
  n += 1;
  sum += x;
  squares += x * x.transpose();
}

void Moments::add(const Moments& other) {
  n += other.n;
  sum += other.sum;
  squares += other.squares;
}

std::vector<elements::Ellipsoid> ellipsoids_of(std::span<const Vec3f> points,
                                               const Clusters& clusters,
                                               const EllipsoidOptions& options) {
  require(clusters.group.size() == points.size(), "clusters and points differ in number");
  require(options.floor_m > 0, "the floor of an ellipsoid must be positive");
  require(options.prior_points >= 0, "the weight of a prior must not be negative");
  std::vector<Cluster> found(clusters.count);
  for (size_t i = 0; i < points.size(); ++i) {
    if (clusters.group[i] == Clusters::kNone) continue;
    Cluster& c = found[clusters.group[i]];
    ++c.n;
    c.mean += points[i].cast<double>();
  }
  for (Cluster& c : found) c.mean /= std::max(1u, c.n);
  for (size_t i = 0; i < points.size(); ++i) {
    if (clusters.group[i] == Clusters::kNone) continue;
    Cluster& c = found[clusters.group[i]];
    const Vec3 d = points[i].cast<double>() - c.mean;
    c.scatter += d * d.transpose();
  }
  const Mat3 prior =
      options.prior_points * typical_variance(found, options.floor_m) * Mat3::Identity();
  std::vector<elements::Ellipsoid> out;
  out.reserve(found.size());
  for (const Cluster& c : found) {
    if (!c.n) continue;
    const double weight = c.n - 1 + options.prior_points;
    elements::Ellipsoid e;
    e.mean = c.mean.cast<float>();
    const Mat3 sigma = weight > 0 ? Mat3((c.scatter + prior) / weight) : Mat3::Zero();
    e.set_covariance(elements::floored_covariance(sigma, options.floor_m));
    out.push_back(e);
  }
  return out;
}

void drop_small(Clusters& clusters, int min_points) {
  std::vector<uint32_t> size(clusters.count);
  for (uint32_t g : clusters.group) {
    if (g != Clusters::kNone) ++size[g];
  }
  uint32_t kept = 0;
  std::vector<uint32_t> number(clusters.count, Clusters::kNone);
  for (uint32_t c = 0; c < clusters.count; ++c) {
    if (size[c] >= uint32_t(std::max(1, min_points))) number[c] = kept++;
  }
  for (uint32_t& g : clusters.group) {
    if (g != Clusters::kNone) g = number[g];
  }
  clusters.count = kept;
}

}  // namespace underbrush::fit
