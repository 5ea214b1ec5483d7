#include <gtest/gtest.h>

#include <set>

#include "underbrush/cluster/hierarchical.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::cluster {
namespace {

std::vector<Vec3f> blobs(uint64_t seed, int count, int points, double sigma) {
  Stream random(seed);
  std::vector<Vec3f> out;
  for (int b = 0; b < count; ++b) {
    const double x = random.uniform(-50, 50), y = random.uniform(-50, 50),
                 z = random.uniform(0, 20);
    for (int i = 0; i < points; ++i) {
      const double dx = random.normal(), dy = random.normal(), dz = random.normal();
      out.emplace_back(float(x + sigma * dx), float(y + sigma * dy), float(z + sigma * dz));
    }
  }
  return out;
}

TEST(HierarchicalClusters, MakesTheNumberAskedAndPutsEveryPointInOne) {
  const std::vector<Vec3f> points = blobs(1, 40, 250, 2);
  HierarchicalOptions options;
  const Clusters c = hierarchical_clusters(points, options, 7);
  EXPECT_NEAR(c.count, options.clusters_per_point * double(points.size()), 0.05 * c.count);
  std::vector<int> size(c.count);
  for (uint32_t g : c.group) {
    ASSERT_LT(g, c.count);
    ++size[g];
  }
  for (int s : size) EXPECT_GE(s, options.min_points);
}

TEST(HierarchicalClusters, FindsWellSeparatedBlobs) {
  const std::vector<Vec3f> points = blobs(2, 20, 100, 0.05);
  HierarchicalOptions options;
  options.clusters_per_point = 30.0 / 2000;
  const Clusters c = hierarchical_clusters(points, options, 3);
  const auto ellipsoids = ellipsoids_of(points, c, {0.001, 0});
  const double one_blob = 3 * 0.05 * 0.05;
  for (const auto& e : ellipsoids) EXPECT_LT(e.covariance_matrix().trace(), 2 * one_blob);
}

TEST(HierarchicalClusters, IsTheSameForTheSameSeedAndMovesWithTheCloud) {
  const std::vector<Vec3f> points = blobs(3, 10, 200, 1);
  const Clusters a = hierarchical_clusters(points, {}, 5), b = hierarchical_clusters(points, {}, 5);
  EXPECT_EQ(a.group, b.group);
  EXPECT_NE(a.group, hierarchical_clusters(points, {}, 6).group);
  std::vector<Vec3f> moved = points;
  for (Vec3f& p : moved) p += Vec3f(64, -32, 8);
  const Clusters m = hierarchical_clusters(moved, {}, 5);
  size_t differ = 0;
  for (size_t i = 0; i < points.size(); ++i) differ += a.group[i] != m.group[i];
  EXPECT_LT(differ, points.size() / 10);  // rounding may move single points to another cluster
}

TEST(HierarchicalClusters, OfFewOrEqualPointsIsClear) {
  EXPECT_EQ(hierarchical_clusters({}, {}, 1).count, 0u);
  const std::vector<Vec3f> two(2, Vec3f(1, 2, 3)), many(100, Vec3f(1, 2, 3));
  EXPECT_EQ(hierarchical_clusters(two, {}, 1).count, 0u);
  EXPECT_EQ(hierarchical_clusters(many, {}, 1).count, 1u);
}

TEST(HierarchicalClusters, OfRepeatedPlacesAreNotSplitAndLeaveTheOthersTheirNumber) {
  const std::vector<Vec3f> repeated = blobs(5, 8, 1000, 0.005);
  std::vector<Vec3f> others = blobs(6, 20, 100, 1), points = repeated;
  for (Vec3f& p : others) p.x() += 200;
  points.insert(points.end(), others.begin(), others.end());
  HierarchicalOptions options;
  options.least_rms_m = 0.02;
  const Clusters c = hierarchical_clusters(points, options, 7);
  std::set<uint32_t> of_repeated(c.group.begin(), c.group.begin() + ptrdiff_t(repeated.size()));
  EXPECT_EQ(of_repeated.size(), 8u);
  EXPECT_NEAR(c.count - 8, 0.1 * double(others.size()), 3);
}

TEST(HierarchicalClusters, FindsTheFewAmongManyEqual) {
  std::vector<Vec3f> points(100000, Vec3f(1, 2, 3));
  std::fill_n(points.begin() + 777, 5, Vec3f(9, 2, 3));
  const Clusters c = hierarchical_clusters(points, {}, 1);
  ASSERT_EQ(c.count, 2u);
  for (size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(c.group[i] == c.group[777], points[i] == points[777]);
  }
}

TEST(EllipsoidsOf, HaveTheSampleMomentsAndAFloor) {
  Stream random(9);
  std::vector<Vec3f> points;
  for (int i = 0; i < 1000; ++i) {
    const double x = random.normal(), y = random.normal();
    points.emplace_back(float(2 * x), float(y), 3.0f);  // a disc without any thickness
  }
  Clusters c;
  c.group.assign(points.size(), 0);
  c.count = 1;
  const auto e = ellipsoids_of(points, c, {0.02, 0});
  ASSERT_EQ(e.size(), 1u);
  Vec3 mean = Vec3::Zero();
  for (const Vec3f& p : points) mean += p.cast<double>() / 1000;
  double xx = 0;
  for (const Vec3f& p : points) xx += (p.x() - mean.x()) * (p.x() - mean.x()) / 999;
  EXPECT_NEAR(e[0].covariance[0], xx, 1e-5);
  EXPECT_NEAR(e[0].covariance[5], 0.005 * 0.005, 1e-8);
  EXPECT_LT((e[0].mean.cast<double>() - mean).norm(), 1e-5);
}

TEST(EllipsoidsOf, FloorFallsWithThePointsToAQuarter) {
  const EllipsoidOptions options{0.02, 0};
  for (const double few : {1.0, 3.0, 10.0}) EXPECT_EQ(options.floor_of(few), 0.02);
  EXPECT_NEAR(options.floor_of(40), 0.01, 1e-12);
  EXPECT_NEAR(options.floor_of(160), 0.005, 1e-12);
  EXPECT_EQ(options.floor_of(1e9), 0.005);
}

// The ellipsoid of a single point gets the usual volume, while many points keep their own shape.
TEST(EllipsoidsOf, TakeFromTheOthersWhatFewPointsDoNotSay) {
  std::vector<Vec3f> points = blobs(11, 1, 2000, 0.3);
  Clusters c;
  c.group.assign(points.size(), 0);
  points.emplace_back(70, 0, 0);
  c.group.push_back(1);
  c.count = 2;
  const auto alone = ellipsoids_of(points, c, {0.02, 0}),
             helped = ellipsoids_of(points, c, {0.02, 1});
  EXPECT_NEAR(alone[1].covariance[0], 0.02 * 0.02, 1e-8);
  EXPECT_NEAR(helped[1].covariance[0], 0.3 * 0.3, 0.005);
  EXPECT_NEAR(helped[1].covariance[5], helped[1].covariance[0], 1e-6);
  EXPECT_NEAR(helped[0].covariance[0], alone[0].covariance[0], 1e-4);
}

TEST(DropSmall, NumbersWhatIsLeftInOrder) {
  Clusters c;
  c.group = {0, 1, 1, 2, Clusters::kNone, 3, 3};
  c.count = 4;
  drop_small(c, 2);
  const uint32_t none = Clusters::kNone;
  EXPECT_EQ(c.group, (std::vector<uint32_t>{none, 0, 0, none, none, 1, 1}));
  EXPECT_EQ(c.count, 2u);
}

}  // namespace
}  // namespace underbrush::cluster
