#include "underbrush/cluster/cluster.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::cluster {
namespace {

struct Cluster {
  uint32_t n = 0;
  Vec3 mean = Vec3::Zero();
  Mat3 scatter = Mat3::Zero();
};

}  // namespace

void PointMoments::add(const Vec3& x) {
  n += 1;
  sum += x;
  squares += x * x.transpose();
}

void PointMoments::add(const PointMoments& other) {
  n += other.n;
  sum += other.sum;
  squares += other.squares;
}

double EllipsoidOptions::floor_of(double n) const {
  constexpr double kFew = 10;
  return std::clamp(floor_m * std::sqrt(kFew / n), least_m(), floor_m);
}

void TypicalVariance::add(double n, const Mat3& scatter) {
  constexpr double kEnough = 5;
  if (n < kEnough) return;
  logs_ += std::log((scatter / (n - 1) + floor_ * Mat3::Identity()).determinant()) / 3;
  count_ += 1;
}

double TypicalVariance::variance() const { return count_ > 0 ? std::exp(logs_ / count_) : 0; }

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
  TypicalVariance typical(options.floor_m);
  for (const Cluster& c : found) typical.add(c.n, c.scatter);
  const Mat3 prior = options.prior_points * typical.variance() * Mat3::Identity();
  std::vector<elements::Ellipsoid> out;
  out.reserve(found.size());
  for (const Cluster& c : found) {
    if (!c.n) continue;
    const double weight = c.n - 1 + options.prior_points;
    elements::Ellipsoid e;
    e.mean = c.mean.cast<float>();
    const Mat3 sigma = weight > 0 ? Mat3((c.scatter + prior) / weight) : Mat3::Zero();
    e.set_covariance(elements::floored_covariance(sigma, options.floor_of(c.n)));
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

}  // namespace underbrush::cluster
