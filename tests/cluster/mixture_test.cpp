#include "underbrush/cluster/mixture.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "underbrush/core/rng.hpp"

namespace underbrush::cluster {
namespace {

struct Seen {
  std::vector<Vec3f> point, to_sensor;
};

Vec3 normal3(Stream& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return {x, y, z};
}

// Makes points of ellipsoids along x, `apart` from one another, Σ = diag(σ²). Planes half-way
// between them cut the points into clusters.
Seen row_of_ellipsoids(int count, double apart, const Vec3& sigma, int points, Clusters& cut) {
  Stream random(11);
  Seen out;
  for (int k = 0; k < count; ++k) {
    for (int i = 0; i < points; ++i) {
      const Vec3 x = Vec3(apart * k, 0, 0) + sigma.cwiseProduct(normal3(random));
      out.point.push_back(x.cast<float>());
      out.to_sensor.push_back((Vec3(0, -20, 0) - x).cast<float>());
      cut.group.push_back(uint32_t(std::clamp(std::lround(x.x() / apart), 0l, long(count) - 1)));
    }
  }
  cut.count = uint32_t(count);
  return out;
}

std::vector<elements::Ellipsoid> fitted(const Seen& seen, const Clusters& clusters,
                                        const MixtureOptions& options, double prior_points = 0) {
  EllipsoidOptions ellipsoid;
  ellipsoid.floor_m = 0.001;
  ellipsoid.prior_points = prior_points;
  return mixture(seen.point, seen.to_sensor, clusters, ellipsoid, options);
}

double log_likelihood(const Seen& seen, const std::vector<elements::Ellipsoid>& ellipsoids) {
  double sum = 0;
  for (const Vec3f& x : seen.point) {
    double f = 0;
    for (const auto& e : ellipsoids) {
      const Mat3 sigma = e.covariance_matrix();
      const Vec3 d = (x - e.mean).cast<double>();
      f += std::exp(-0.5 * d.dot(sigma.inverse() * d)) / std::sqrt(sigma.determinant());
    }
    sum += std::log(f);
  }
  return sum / double(seen.point.size());
}

// Clusters cut the tails of ellipsoids that overlap, and the mixture restores them.
TEST(Mixture, FindsEllipsoidsThatOverlap) {
  Clusters cut;
  const Seen seen = row_of_ellipsoids(3, 1.0, {0.4, 0.1, 0.2}, 4000, cut);
  MixtureOptions options;
  options.rounds = 0;
  const double of_clusters = fitted(seen, cut, options)[1].covariance_matrix()(0, 0);
  options.rounds = 200;
  const auto found = fitted(seen, cut, options);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_LT(std::sqrt(of_clusters), 0.3);
  for (size_t k = 0; k < 3; ++k) {
    const Mat3 sigma = found[k].covariance_matrix();
    EXPECT_NEAR(found[k].mean.x(), double(k), 0.05) << k;
    EXPECT_NEAR(std::sqrt(sigma(0, 0)), 0.4, 0.04) << k;
    EXPECT_NEAR(std::sqrt(sigma(1, 1)), 0.1, 0.01) << k;
  }
}

// Expectation–maximisation guarantees that the likelihood never falls.
TEST(Mixture, EveryRoundRaisesTheLikelihood) {
  Clusters cut;
  const Seen seen = row_of_ellipsoids(3, 1.0, {0.4, 0.1, 0.2}, 500, cut);
  double before = -INFINITY;
  for (const int rounds : {0, 1, 2, 4, 8, 16}) {
    MixtureOptions options;
    options.rounds = rounds;
    const double now = log_likelihood(seen, fitted(seen, cut, options));
    EXPECT_GT(now, before) << rounds;
    before = now;
  }
}

// Matter of σ 0.05 m is seen by a beam of σ 0.15 × 0.06 m. The mixture gives it its own width, from
// whatever direction it was seen.
TEST(Mixture, TakesTheFootprintAway) {
  const Vec3 truth(0.05, 0.04, 0.1);
  for (const Vec3& from : {Vec3(0, -20, 0), Vec3(-15, 0, 4), Vec3(9, 9, 0)}) {
    Stream random(5);
    const Vec3 back = from.normalized(), right = Vec3::UnitZ().cross(back).normalized();
    const Vec3 up = back.cross(right);
    Seen seen;
    Clusters one;
    one.count = 1;
    for (int i = 0; i < 6000; ++i) {
      const Vec3 y = truth.cwiseProduct(normal3(random));
      const Vec3 x = y + 0.15 * random.normal() * right + 0.06 * random.normal() * up;
      seen.point.push_back(x.cast<float>());
      seen.to_sensor.push_back((from - x).cast<float>());
      one.group.push_back(0);
    }
    MixtureOptions options;
    options.rounds = 200;
    const Mat3 blurred = fitted(seen, one, options)[0].covariance_matrix();
    options.footprint = [](double) { return std::array{0.15, 0.06}; };
    const Mat3 sharp = fitted(seen, one, options)[0].covariance_matrix();
    const Mat3 expected = truth.cwiseAbs2().asDiagonal();
    EXPECT_GT((blurred - expected).norm(), 0.02);
    EXPECT_LT((sharp - expected).norm(), 0.0025) << from.transpose();
  }
}

// The footprint is evaluated at the range of each point.
TEST(Mixture, TheFootprintGrowsWithTheRange) {
  Clusters cut;
  const Seen seen = row_of_ellipsoids(1, 1.0, {0.1, 0.1, 0.1}, 300, cut);
  MixtureOptions options;
  double least = INFINITY, most = 0;
  options.footprint = [&](double range) {
    least = std::min(least, range);
    most = std::max(most, range);
    return std::array{0.002 * range, 0.001 * range};
  };
  fitted(seen, cut, options);
  EXPECT_NEAR(least, 19.7, 0.2);
  EXPECT_NEAR(most, 20.3, 0.2);
}

TEST(Mixture, WithoutARoundItIsTheClusters) {
  Clusters cut;
  const Seen seen = row_of_ellipsoids(2, 1.0, {0.3, 0.1, 0.2}, 50, cut);
  MixtureOptions options;
  options.rounds = 0;
  const auto found = fitted(seen, cut, options, 1);
  EllipsoidOptions ellipsoid;
  ellipsoid.floor_m = 0.001;
  const auto clusters = ellipsoids_of(seen.point, cut, ellipsoid);
  ASSERT_EQ(found.size(), clusters.size());
  for (size_t k = 0; k < found.size(); ++k) {
    EXPECT_EQ(found[k].covariance, clusters[k].covariance);
    EXPECT_EQ(found[k].mean, clusters[k].mean);
  }
}

// For one cluster the mixture has scatter / n, where the cluster's own covariance is scatter / (n −
// 1).
TEST(Mixture, OfOneClusterTakesTheMomentsOfItsPoints) {
  Clusters one;
  one.count = 1;
  one.group.assign(4, 0);
  Seen seen;
  seen.point = {{1, 0, 0}, {-1, 0, 0}, {0, 2, 1}, {0, -2, -1}};
  seen.to_sensor.assign(4, {9, 0, 0});
  MixtureOptions options;
  const Mat3 sigma = fitted(seen, one, options)[0].covariance_matrix();
  options.rounds = 0;
  const Mat3 of_cluster = fitted(seen, one, options)[0].covariance_matrix();
  EXPECT_NEAR(sigma(0, 0), 0.5, 1e-5);
  EXPECT_NEAR(sigma(1, 1), 2, 1e-5);
  EXPECT_NEAR(sigma(1, 2), 1, 1e-5);
  EXPECT_NEAR(of_cluster(1, 1), 8.0 / 3, 1e-5);
}

// An ellipsoid whose points all belong to its neighbours is dropped, and points of no cluster have
// no effect.
TEST(Mixture, DropsWhatHoldsNoPoints) {
  Clusters cut;
  Seen seen = row_of_ellipsoids(1, 1.0, {0.3, 0.3, 0.3}, 400, cut);
  cut.count = 2;
  cut.group[7] = 1;  // one point in the middle of the others
  for (int i = 0; i < 5; ++i) {
    seen.point.push_back({100, 0, 0});
    seen.to_sensor.push_back({1, 0, 0});
    cut.group.push_back(Clusters::kNone);
  }
  MixtureOptions options;
  options.least_points = 30;
  const auto found = fitted(seen, cut, options, 1);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT(found[0].mean.norm(), 0.1);
  options.rounds = -1;
  EXPECT_THROW(fitted(seen, cut, options), std::invalid_argument);
  options.rounds = 1;
  options.shared_by = 0;
  EXPECT_THROW(fitted(seen, cut, options), std::invalid_argument);
  options.shared_by = 3;
  seen.to_sensor.pop_back();
  EXPECT_THROW(fitted(seen, cut, options), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::cluster
