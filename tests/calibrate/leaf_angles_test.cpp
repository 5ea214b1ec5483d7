#include "underbrush/calibrate/leaf_angles.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"

namespace underbrush::calibrate {
namespace {

constexpr double kLow = 3, kHigh = 9, kHalfWidth = 15;  // m, of the slab of leaves

/// A model of flat ground at z = 0.
elements::Model ground_at_zero() {
  elements::Model m;
  m.max_range_m = 60;
  for (int x = -40; x <= 40; x += 2) {
    for (int y = -40; y <= 40; y += 2) m.ground.vertices.emplace_back(float(x), float(y), 0.0f);
  }
  return m;
}

struct Crossing {
  double enter_m = 0, leave_m = 0;
};

/// The way of a ray through the slab.
Crossing crossing_of(const Ray& ray) {
  const Vec3 low(-kHalfWidth, -kHalfWidth, kLow), high(kHalfWidth, kHalfWidth, kHigh);
  Crossing out{0, 60};
  for (int k = 0; k < 3; ++k) {
    const double a = (low[k] - ray.origin[k]) / ray.direction[k],
                 b = (high[k] - ray.origin[k]) / ray.direction[k];
    out.enter_m = std::max(out.enter_m, std::min(a, b));
    out.leave_m = std::min(out.leave_m, std::max(a, b));
  }
  return out;
}

/// Beams from five tripods under a slab of leaves whose density changes from place to place, in all
/// directions above the horizon.
BeamLog tripods_under(const LeafAngleDistribution& leaves, size_t beams) {
  BeamLog log;
  log.info.max_range_m = 60;
  log.info.has_misses = true;
  log.resize(beams);
  Stream random(3);
  for (size_t i = 0; i < beams; ++i) {
    const double bearing = 2 * M_PI * double(i % 5) / 5, from_m = i % 5 == 0 ? 0 : 12;
    log.origin[i] = {from_m * std::cos(bearing), from_m * std::sin(bearing), 1.5};
    const double azimuth = random.uniform(0, 2 * M_PI), z = random.uniform(0.05, 1);
    const double r = std::sqrt(1 - z * z);
    log.direction[i] = Vec3(r * std::cos(azimuth), r * std::sin(azimuth), z).cast<float>();
    const Ray ray = log.ray(i);
    const Crossing way = crossing_of(ray);
    double depth = -std::log(1 - random.uniform()), t = way.enter_m;
    constexpr double kStep = 0.05;
    for (; t < way.leave_m && depth > 0; t += kStep) {
      const Vec3 p = ray.origin + t * ray.direction;
      const double density = 0.25 * (1.5 + std::sin(0.2 * p.x()) * std::cos(0.3 * p.y()));
      depth -= density * 2 * leaves.projection(ray.direction.z()) * kStep;
    }
    log.range_m[i] = depth <= 0 ? float(t) : kMiss;
  }
  return log;
}

LeafAngleReport learnt(elements::Model& model, const BeamLog& log) {
  MemorySource source(log, 10000);
  return learn_leaf_angles(model, source, log.info, 0.1);
}

class LearnLeafAngles : public testing::TestWithParam<double> {};

TEST_P(LearnLeafAngles, FindsThoseOfASlabOfUnevenDensity) {
  elements::Model model = ground_at_zero();
  const LeafAngleReport r =
      learnt(model, tripods_under(LeafAngleDistribution(GetParam()), 200'000));
  EXPECT_GT(r.cells, 500u);
  EXPECT_NEAR(std::log(r.chi), std::log(GetParam()), 0.2);
  EXPECT_EQ(r.used, GetParam() != 1);
  EXPECT_NEAR(std::log(model.leaf_angles.shape()), std::log(GetParam()), 0.25);
}
INSTANTIATE_TEST_SUITE_P(Chi, LearnLeafAngles, testing::Values(0.3, 1.0, 3.0));

// Leaves that all lie flat or stand upright have no finite χ.
TEST(LearnLeafAngles, FindsThatLeavesLieFlatOrStandUpright) {
  for (const double chi : {0.01, 100.0}) {
    elements::Model model = ground_at_zero();
    learnt(model, tripods_under(LeafAngleDistribution(chi), 50'000));
    EXPECT_GT(std::abs(std::log(model.leaf_angles.shape())), 2) << chi;
    EXPECT_EQ(model.leaf_angles.shape() > 1, chi > 1);
  }
}

TEST(LearnLeafAngles, WideBeamsSayNothing) {
  BeamLog log = tripods_under(LeafAngleDistribution(3), 20'000);
  log.info.sensor = "sick-lms511";
  elements::Model model = ground_at_zero();
  EXPECT_EQ(learnt(model, log).cells, 0u);
  EXPECT_TRUE(model.leaf_angles.spherical());
}

// Without its misses, a log looks as if leaves stopped all beams towards the sky.
TEST(LearnLeafAngles, NothingIsLearntWithoutMisses) {
  BeamLog log = tripods_under(LeafAngleDistribution(3), 20'000);
  log.info.has_misses = false;
  elements::Model model = ground_at_zero();
  EXPECT_FALSE(learnt(model, log).used);
  EXPECT_TRUE(model.leaf_angles.spherical());
}

TEST(LearnLeafAngles, FlatBeamsSayTooLittle) {
  BeamLog log = tripods_under(LeafAngleDistribution(3), 20'000);
  for (Vec3f& d : log.direction) d = Vec3f(d.x(), d.y(), 0.2f * d.z()).normalized();
  elements::Model model = ground_at_zero();
  EXPECT_EQ(learnt(model, log).cells, 0u);
  EXPECT_TRUE(model.leaf_angles.spherical());
}

TEST(LearnLeafAngles, WallsAndGroundAreNoLeaves) {
  elements::Model model = ground_at_zero();
  model.leaf_angles = LeafAngleDistribution(4);
  BeamLog log = tripods_under(LeafAngleDistribution(1), 50'000);
  for (size_t i = 0; i < log.size(); ++i) {
    if (i % 2) log.direction[i].z() *= -1;
    const Vec3 d = log.direction[i].cast<double>();
    const double to_wall = (20 - log.origin[i].x()) / d.x(), to_ground = -log.origin[i].z() / d.z();
    double range = HUGE_VAL;
    if (to_wall > 0) range = to_wall;
    if (to_ground > 0) range = std::min(range, to_ground);
    log.range_m[i] = range < 60 ? float(range) : kMiss;
  }
  const LeafAngleReport r = learnt(model, log);
  EXPECT_EQ(r.cells, 0u);
  EXPECT_TRUE(model.leaf_angles.spherical());
}

}  // namespace
}  // namespace underbrush::calibrate
