#include "underbrush/sites/point_process.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "primitives/sites.hpp"
#include "underbrush/sites/arrangement.hpp"

namespace underbrush::sites {
namespace {

using elements::Class;
using primitives::GroundSurface;

/// A square site of 100 m.
class PointProcessTest : public testing::Test {
 protected:
  elements::Model model = test::plane(50, 0, 0);
  GroundSurface ground{model};
  Window window{ground};

  std::vector<MarkedPoint> even(size_t n, double radius_m, uint64_t seed) const {
    Stream random(seed);
    std::vector<MarkedPoint> out;
    for (size_t k = 0; k < n; ++k)
      out.push_back({window.draw(random), Class::kSmallTree, radius_m});
    return out;
  }
  /// Pairs nearer than a distance, in sites that are drawn from the fit.
  double drawn_pairs(const PointProcess& process, std::vector<MarkedPoint> points,
                     double distance_m) const {
    double sum = 0;
    for (uint64_t seed = 1; seed <= 10; ++seed) {
      draw_places(process, window, points, seed);
      sum += pairs(points, distance_m) / 10;
    }
    return sum;
  }
  static double pairs(const std::vector<MarkedPoint>& points, double distance_m) {
    double n = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      for (size_t j = 0; j < i; ++j) n += (points[i].at - points[j].at).norm() < distance_m;
    }
    return n;
  }
};

TEST_F(PointProcessTest, CountsEachPairInItsInterval) {
  std::vector<MarkedPoint> points = even(300, 0.5, 1);
  for (size_t k = 0; k < points.size(); k += 3) points[k].label = Class::kLowShrub;
  const PairSteps counted = Arrangement(window, points).pairs();
  PairSteps expected;
  for (size_t i = 0; i < points.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      expected.count(points[i], points[j], (points[i].at - points[j].at).norm());
    }
  }
  EXPECT_EQ(counted.values, expected.values);
  double all = 0;
  for (size_t k = 0; k < counted.values.size(); ++k) {
    if (k % PairSteps::kIntervals < PairSteps::kDistances.size()) all += counted.values[k];
  }
  EXPECT_EQ(all, pairs(points, PairSteps::kReachM));
}

TEST_F(PointProcessTest, PointsWithoutInteractionGetNone) {
  const std::vector<MarkedPoint> points = even(500, 0.1, 2);
  const PointProcess fitted = fit_process(window, points, 1);
  const size_t trees = 2 * PairSteps::kIntervals;  // Of pairs of two trees.
  for (size_t k = 2; k < PairSteps::kDistances.size(); ++k) {
    EXPECT_NEAR(fitted.steps.values[trees + k], 0, 0.35) << k;
    EXPECT_NEAR(fitted.correlation.values[trees + k], 1, 0.25) << k;
  }
  EXPECT_LT(fitted.gradient.at(Class::kSmallTree).norm(), 0.3);
}

TEST_F(PointProcessTest, KeepsPointsApartThatStandApart) {
  std::vector<MarkedPoint> points;
  for (const MarkedPoint& p : even(5000, 0.1, 3)) {
    points.push_back(p);
    if (points.size() > 1 && pairs(points, 3) > 0) points.pop_back();
    if (points.size() == 400) break;
  }
  ASSERT_EQ(points.size(), 400u);
  const double unrelated = pairs(even(400, 0.1, 4), 3);
  EXPECT_GT(unrelated, 150);
  EXPECT_LT(drawn_pairs(fit_process(window, points, 1), points, 3), 0.05 * unrelated);
}

TEST_F(PointProcessTest, ClustersPointsThatStandInClusters) {
  Stream random(5);
  std::vector<MarkedPoint> points;
  for (int cluster = 0; cluster < 40; ++cluster) {
    const Eigen::Vector2d middle = window.draw(random);
    for (int k = 0; k < 8; ++k) {
      const double dx = random.normal(), dy = random.normal();
      const Eigen::Vector2d at = middle + 1.5 * Eigen::Vector2d(dx, dy);
      if (window.contains(at)) points.push_back({at, Class::kLowShrub, 0.3});
    }
  }
  const PointProcess fitted = fit_process(window, points, 1);
  for (const double distance : {1.0, 2.0, 4.0, 8.0}) {
    const double wanted = pairs(points, distance);
    EXPECT_NEAR(drawn_pairs(fitted, points, distance), wanted, 0.15 * wanted) << distance;
  }
}

TEST_F(PointProcessTest, LargePlantsKeepFartherApart) {
  // Crowns that touch but do not overlap; small and large ones in equal number.
  std::vector<MarkedPoint> points;
  Stream random(6);
  const auto overlap = [](const std::vector<MarkedPoint>& all, const MarkedPoint& p) {
    size_t n = 0;
    for (const MarkedPoint& q : all) {
      const double d = (q.at - p.at).norm();
      n += d > 0 && d < 0.75 * (q.radius_m + p.radius_m);
    }
    return n;
  };
  for (int tries = 0; points.size() < 250 && tries < 100000; ++tries) {
    const MarkedPoint p{window.draw(random), Class::kSmallTree, points.size() % 2 ? 3.0 : 1.0};
    if (overlap(points, p) == 0) points.push_back(p);
  }
  ASSERT_EQ(points.size(), 250u);
  const PointProcess fitted = fit_process(window, points, 1);
  draw_places(fitted, window, points, 7);
  size_t overlaps = 0;
  for (const MarkedPoint& p : points) overlaps += overlap(points, p);
  std::vector<MarkedPoint> unrelated = points;
  Stream again(7);
  for (MarkedPoint& p : unrelated) p.at = window.draw(again);
  size_t of_unrelated = 0;
  for (const MarkedPoint& p : unrelated) of_unrelated += overlap(unrelated, p);
  EXPECT_LT(double(overlaps), 0.1 * double(of_unrelated));
}

TEST_F(PointProcessTest, FindsTheGradient) {
  Stream random(8);
  std::vector<MarkedPoint> points;
  const Eigen::Vector2d b(0.8, -0.5);
  while (points.size() < 1000) {
    const Eigen::Vector2d at = window.draw(random);
    if (std::log(random.uniform()) < b.dot(window.relative(at)) - 1.3) {
      points.push_back({at, Class::kMediumTree, 0.2});
    }
  }
  const PointProcess fitted = fit_process(window, points, 1);
  EXPECT_LT((fitted.gradient.at(Class::kMediumTree) - b).norm(), 0.2);
}

TEST_F(PointProcessTest, DependsOnTheSeedAlone) {
  const std::vector<MarkedPoint> points = even(100, 0.5, 9);
  const PointProcess a = fit_process(window, points, 1), b = fit_process(window, points, 1);
  EXPECT_EQ(a.steps.values, b.steps.values);
  std::vector<MarkedPoint> first = points, again = points, other = points;
  draw_places(a, window, first, 1);
  draw_places(b, window, again, 1);
  draw_places(a, window, other, 2);
  for (size_t k = 0; k < points.size(); ++k) EXPECT_EQ(first[k].at, again[k].at);
  EXPECT_NE(first[0].at, other[0].at);
}

}  // namespace
}  // namespace underbrush::sites
