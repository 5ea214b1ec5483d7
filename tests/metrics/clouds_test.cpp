#include "underbrush/metrics/clouds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::metrics {
namespace {

/// Adds a beam that returns from a point, seen from above it, or none of a missing point.
void add(const Vec3& point, double range_m, BeamLog& log) {
  const size_t i = log.size();
  log.resize(i + 1);
  log.info.max_range_m = 200;
  log.origin[i] = point + range_m * Vec3::UnitZ();
  log.direction[i] = -Vec3f::UnitZ();
  log.range_m[i] = float(range_m);
}

/// Points over a square of 40 m, whose heights are those of hills and of some plants.
BeamLog site(uint64_t seed, size_t points, const Vec3& shift = Vec3::Zero()) {
  Stream random(seed);
  BeamLog log;
  for (size_t k = 0; k < points; ++k) {
    const double x = random.uniform(0, 40), y = random.uniform(0, 40);
    const double plant = random.uniform() < 0.3 ? random.uniform(0, 8) : 0;
    add(Vec3(x, y, 0.1 * x + plant) + shift, 50 - plant, log);
  }
  return log;
}

CloudScores scores_of(const BeamLog& real, const BeamLog& simulated) {
  MemorySource a(real, 1000), b(simulated, 777);
  return compare_clouds(a, b);
}

TEST(Clouds, ACloudIsAsItselfInAnyOrder) {
  const BeamLog log = site(41, 5000);
  BeamLog turned = log.like();
  for (size_t i = log.size(); i-- > 0;) turned.append(log, i);
  const CloudScores s = scores_of(log, turned);
  EXPECT_EQ(s.points[0], s.points[1]);
  EXPECT_EQ(s.cloud_error_m, 0);
  EXPECT_EQ(s.density_aware_chamfer, 0);
  EXPECT_EQ(s.occupied, 1);
  EXPECT_EQ(s.range.distance_m, 0);
  EXPECT_EQ(s.height.distance_m, 0);
  ASSERT_EQ(s.regions.size(), 4u);
  for (const CloudRegion& r : s.regions) EXPECT_EQ(r.cloud_error_m, 0);
}

TEST(Clouds, AShiftedCloudIsAsFarOffAsItsShift) {
  // Points so far apart that each one's nearest is its own copy.
  BeamLog real, simulated;
  for (int x = 0; x < 20; ++x) {
    for (int y = 0; y < 20; ++y) {
      add(Vec3(x + 0.5, y + 0.5, 0), 30, real);
      add(Vec3(x + 0.5, y + 0.5, 0.3), 29.5, simulated);
    }
  }
  const CloudScores s = scores_of(real, simulated);
  EXPECT_NEAR(s.nearest_m[0], 0.3, 1e-6);
  EXPECT_NEAR(s.nearest_m[1], 0.3, 1e-6);
  EXPECT_NEAR(s.cloud_error_m, 0.3, 1e-6);
  EXPECT_NEAR(s.density_aware_chamfer, 1 - std::exp(-3), 1e-6);
  EXPECT_EQ(s.occupied, 0);
  EXPECT_NEAR(s.height.distance_m, 0.3, 1e-6);
  EXPECT_NEAR(s.range.distance_m, 0.5, 1e-6);
}

TEST(Clouds, APartOfACloudMissesSomeOfItAndMakesNothingUp) {
  const BeamLog real = site(42, 9000);
  BeamLog third = real.like();
  for (size_t i = 0; i < real.size(); i += 3) third.append(real, i);
  const CloudScores s = scores_of(real, third);
  EXPECT_EQ(s.nearest_m[1], 0);
  EXPECT_GT(s.nearest_m[0], 0.1);
  EXPECT_LT(s.height.distance_m, 0.1);
  EXPECT_LT(s.occupied, 0.5);
  const CloudScores back = scores_of(third, real);
  EXPECT_EQ(back.nearest_m[0], s.nearest_m[1]);
  EXPECT_EQ(back.nearest_m[1], s.nearest_m[0]);
  EXPECT_EQ(back.occupied, s.occupied);
  EXPECT_EQ(back.range.distance_m, s.range.distance_m);
}

TEST(Clouds, DistancesOfDistributionsAreThoseOfWasserstein) {
  BeamLog real, simulated;
  for (const double r : {1.0, 3.0}) add(Vec3(0, 0, 0), r, real);
  for (const double r : {2.0, 3.0, 3.0, 8.0}) add(Vec3(0, 0, 0), r, simulated);
  // Quantiles 1 1 3 3 against 2 3 3 8: (1 + 2 + 0 + 5) / 4.
  EXPECT_NEAR(scores_of(real, simulated).range.distance_m, 2, 1e-6);
}

TEST(Clouds, SharesOfBinsAddUpToOne) {
  const CloudScores s = scores_of(site(43, 3000), site(44, 1000));
  for (const LengthDistribution& d : {s.range, s.height}) {
    for (const std::vector<double>& share : d.share) {
      double sum = 0;
      for (const double x : share) sum += x;
      EXPECT_NEAR(sum, 1, 1e-9);
    }
  }
}

TEST(Clouds, CountTheReturnsOfABeam) {
  BeamLog log;
  std::vector<int32_t> echo;
  for (const int returns : {0, 1, 2, 4, 1}) {
    for (int k = 0; k < std::max(1, returns); ++k) {
      add(Vec3(k, returns, 0), 10, log);
      if (returns == 0) log.range_m.back() = kMiss;
      echo.push_back(k + 1);
    }
  }
  log.extra[kEchoColumn] = echo;
  const CloudScores s = scores_of(log, log);
  EXPECT_EQ(s.beams[0], 5u);
  EXPECT_EQ(s.points[0], 8u);
  const std::array<double, 4> expected{0.2, 0.4, 0.2, 0.2};
  for (size_t k = 0; k < 4; ++k) EXPECT_NEAR(s.returns[1][k], expected[k], 1e-12) << k;
}

TEST(Clouds, RegionsTellWhereACloudLacksPoints) {
  const BeamLog real = site(45, 4000);
  BeamLog simulated = real.like();
  for (size_t i = 0; i < real.size(); ++i) {
    if (real.origin[i].x() > 20) simulated.append(real, i);
  }
  const CloudScores s = scores_of(real, simulated);
  ASSERT_EQ(s.regions.size(), 4u);
  double share = 0;
  for (const CloudRegion& r : s.regions) {
    EXPECT_GT(r.points[0], 0u);
    EXPECT_EQ(r.points[1] == 0, r.at.x == 0);
    EXPECT_EQ(std::isnan(r.height_distance_m), r.at.x == 0);
    if (r.at.x == 0) {
      EXPECT_GT(r.cloud_error_m, 5);  // 10 m on average from the middle
      share += r.error_share;
    } else {
      EXPECT_EQ(r.cloud_error_m, 0);
    }
  }
  EXPECT_NEAR(share, 1, 1e-9);
}

TEST(Clouds, ProgressReachesAllRowsAndPoints) {
  const BeamLog real = site(47, 300'000), simulated = site(48, 2000);
  MemorySource a(real, 10'000), b(simulated, 777);
  std::vector<size_t> steps;
  compare_clouds(a, b, [&](size_t done, size_t total) {
    EXPECT_EQ(total, 2 * (real.size() + simulated.size()));
    steps.push_back(done);
  });
  EXPECT_TRUE(std::is_sorted(steps.begin(), steps.end()));
  EXPECT_EQ(steps.front(), 0u);
  EXPECT_EQ(steps.back(), 602'000u);
  EXPECT_EQ(std::count(steps.begin(), steps.end(), 302'000u), 1);  // The comparison begins.
  EXPECT_GT(steps.size(), 100u);
}

TEST(Clouds, OfNoPointsAreRefused) {
  const BeamLog log = site(46, 10);
  BeamLog none = log;
  for (float& r : none.range_m) r = kMiss;
  EXPECT_THROW(scores_of(log, none), DataError);
  EXPECT_THROW(scores_of(none, log), DataError);
  EXPECT_THROW(scores_of(BeamLog(), log), DataError);
}

}  // namespace
}  // namespace underbrush::metrics
