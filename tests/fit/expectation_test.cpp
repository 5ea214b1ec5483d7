#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/fit/element_sums.hpp"
#include "underbrush/fit/rearrangement.hpp"
#include "underbrush/metrics/predictive.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::fit {
namespace {

std::vector<trace::Intersection> random_mets(Stream& random, size_t n) {
  std::vector<trace::Intersection> met;
  double t = 2;
  for (uint32_t k = 0; k < n; ++k) {
    t += random.uniform(0, 3);
    const double sigma = random.uniform(0.05, 2), p = random.uniform();
    met.push_back({t, sigma, random.uniform(0, 4), p, k});
  }
  return met;
}

TEST(Responsibilities, SumToOneAndTheirLikelihoodIsThatOfTheScore) {
  Stream random(21);
  for (int i = 0; i < 200; ++i) {
    const std::vector<trace::Intersection> met = random_mets(random, i % 7);
    const double range = i % 3 ? random.uniform(0, 20) : double(kMiss);
    Responsibilities shares;
    find_responsibilities(met, range, {}, 100, shares);
    double sum = shares.unexplained;
    for (size_t k = 0; k < met.size(); ++k) sum += shares.hit[k];
    if (range == kMiss && !met.empty()) sum += shares.pass[0];
    if (range == kMiss && met.empty()) sum = 1;
    EXPECT_NEAR(sum, 1, 1e-12);
    for (size_t k = 1; k < met.size(); ++k) {
      EXPECT_NEAR(shares.pass[k - 1], shares.pass[k] + shares.hit[k], 1e-12);
    }
    trace::RangeMixture p;
    trace::mix_ranges(met, 1, 0, p);
    EXPECT_NEAR(-shares.log_likelihood, metrics::negative_log_likelihood(p, range, 100), 1e-9);
  }
}

TEST(Responsibilities, OfTwoElementsByHand) {
  const std::vector<trace::Intersection> met{{10, 0.1, 0, 0.5, 0}, {10.2, 0.2, 0, 0.8, 1}};
  const auto density = [](double x, double s) {
    return std::exp(-0.5 * x * x / (s * s)) / (s * std::sqrt(2 * M_PI));
  };
  const double a = 0.9 * 0.5 * density(0.1, 0.1), b = 0.9 * 0.5 * 0.8 * density(-0.1, 0.2);
  Responsibilities shares;
  find_responsibilities(met, 10.1, {0.06, 0.04}, 50, shares);
  const double total = a + b + 0.06 / 50;
  EXPECT_NEAR(shares.hit[0], a / total, 1e-12);
  EXPECT_NEAR(shares.pass[0], b / total, 1e-12);
  EXPECT_NEAR(shares.pass[1], 0, 1e-12);
  find_responsibilities(met, kMiss, {0.06, 0.04}, 50, shares);
  EXPECT_NEAR(shares.pass[1], 0.9 * 0.1 / (0.9 * 0.1 + 0.04), 1e-12);
}

/// Computes the expected log-likelihood of fixed shares as the one ellipsoid moves.
double expected(const elements::Model& model, const std::vector<Ray>& rays,
                const std::vector<double>& ranges,
                const std::vector<std::array<double, 2>>& shares) {
  double sum = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const trace::Intersection m =
        trace::intersect(model, 0, rays[i].origin, rays[i].direction, {-100, 100});
    if (m.none()) continue;
    const double x = (ranges[i] - m.t_m) / m.sigma_m;
    sum += shares[i][0] * (std::log(m.p) - std::log(m.sigma_m) - 0.5 * x * x) +
           shares[i][1] * std::log1p(-m.p);
  }
  return sum;
}

/// The slopes are compared with finite differences in all ten parameters.
TEST(ElementSums, SlopesAreTheDerivativesOfTheExpectedLogLikelihood) {
  Stream random(22);
  elements::Model model;
  model.tau = 50;
  elements::Ellipsoid e;
  e.mean = Vec3f(0.5f, -0.25f, 1);
  Mat3 root;
  root << 0.8, 0, 0, 0.2, 0.5, 0, -0.1, 0.3, 0.6;
  e.set_covariance(root * root.transpose());
  e.density_per_m = 1.2f;
  model.ellipsoids = {e};
  std::vector<Ray> rays;
  std::vector<double> ranges;
  std::vector<std::array<double, 2>> given;
  ElementSums sums(model);
  for (int i = 0; i < 40; ++i) {
    Vec3 from(random.normal(), random.normal(), random.normal());
    from = 6 * from.normalized();
    const Vec3 to(0.8 * random.normal(), 0.8 * random.normal(), 1 + 0.8 * random.normal());
    rays.push_back({from, (to - from).normalized()});
    trace::Intersection met =
        trace::intersect(model, 0, rays.back().origin, rays.back().direction, {-100, 100});
    ASSERT_FALSE(met.none());
    ranges.push_back(met.t_m + met.sigma_m * random.normal());
    const double hit = random.uniform(), pass = random.uniform(0, 1 - hit);
    given.push_back({hit, pass});
    sums.add(rays.back(), {&met, 1}, ranges.back(), {{hit}, {pass}, 0, 0, {}});
  }
  const EllipsoidSums s = sums.ellipsoid(0);
  const auto slope = [&](const std::function<void(elements::Ellipsoid&, double)>& move) {
    const double step = 2e-3;
    double at[2];
    for (int side = 0; side < 2; ++side) {
      elements::Model moved = model;
      move(moved.ellipsoids[0], side ? step : -step);
      at[side] = expected(moved, rays, ranges, given);
    }
    return (at[1] - at[0]) / (2 * step);
  };
  const Mat3 l = Eigen::LLT<Mat3>(e.covariance_matrix()).matrixL();
  EXPECT_NEAR(slope([](auto& x, double h) { x.density_per_m *= float(std::exp(h)); }),
              s.density_slope, 0.02);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(slope([&](auto& x, double h) { x.mean += (h * l.col(k)).template cast<float>(); }),
                s.shift_slope[k], 0.02);
    for (int j = k; j < 3; ++j) {
      Mat3 unit = Mat3::Zero();
      unit(j, k) = unit(k, j) = 1;
      const double want = s.stretch_slope(j, k) * (j == k ? 1 : 2);
      EXPECT_NEAR(slope([&](auto& x, double h) {
                    const Mat3 f = l * (Mat3::Identity() + h * unit);
                    x.set_covariance(f * f.transpose());
                  }),
                  want, 0.03);
    }
  }
}

TEST(Rearrangement, HalvesHaveTheMomentsOfTheWholeAndMergeToIt) {
  elements::Ellipsoid e;
  e.mean = Vec3f(1, 2, 3);
  e.set_covariance(Vec3(0.5, 0.2, 0.1).asDiagonal());
  e.density_per_m = 2;
  const auto two = halves(e);
  EXPECT_GT((two[1].mean - two[0].mean).norm(), 1);
  const elements::Ellipsoid back = merged(two[0], 7, two[1], 7);
  EXPECT_LT((back.mean - e.mean).norm(), 1e-6);
  EXPECT_LT((back.covariance_matrix() - e.covariance_matrix()).norm(), 1e-6);
  EXPECT_NEAR(back.density_per_m, e.density_per_m, 1e-5);
}

TEST(Rearrangement, RemovesTheEmptyMergesTwinsAndNeverAdds) {
  elements::Model model;
  for (int k = 0; k < 40; ++k) {
    elements::Ellipsoid e;
    // pairs of near ellipsoids, far from other pairs
    e.mean = Vec3f(float(k / 2) * 5, k % 2 ? 0.01f : 0.0f, 0);
    e.set_covariance(0.04 * Mat3::Identity());
    e.density_per_m = 1;
    model.ellipsoids.push_back(e);
  }
  ElementSums sums(model);
  trace::Intersection met{10, 0.2, 0.5, 0.3, 0};
  for (uint32_t k = 0; k < 40; ++k) {
    if (k < 4) continue;  // no beam meets the first four
    met.element = k;
    for (int i = 0; i < 30; ++i) {
      sums.add({Vec3(-10, 0, 0), Vec3(1, 0, 0)}, {&met, 1}, 10, {{0.9}, {0.1}, 0, -double(k), {}});
    }
  }
  RearrangementOptions options;
  options.share = 0.25;
  options.split_share = 0;
  EXPECT_EQ(rearranged(model, sums, options).ellipsoids.size(), 40u - 4 - 10);
  options.split_share = 0.5;
  options.split_hits = 1;
  const elements::Model split = rearranged(model, sums, options);
  EXPECT_EQ(split.ellipsoids.size(), 40u - 4 - 10 + 7);
}

}  // namespace
}  // namespace underbrush::fit
