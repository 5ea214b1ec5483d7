// Laws of matter that sways: at two times it is the same matter with a probability that falls
// evenly over the correlation time, at every time it has the distribution of still matter, and what
// is no ellipsoid stands.
#include <gtest/gtest.h>

#include <cmath>

#include "simulate/targets.hpp"

namespace underbrush::simulate {
namespace {

constexpr double kSpread = 0.3, kSway = 0.5;  // m, s
constexpr size_t kBeams = 6000;

/// A permeable wall of one ellipsoid, or of triangles, 20 m away along x.
elements::Model target(bool ellipsoid, float p) {
  elements::Model model;
  model.tau = 3;
  model.grain.ellipsoid_m = model.grain.mesh_m = 0.1;
  if (!ellipsoid) {
    add_wall(model, 20, -100, 4000);
    for (auto& h : model.surface.hit) h.p = p;
    model.surface.range_sigma_m = kSpread;
    return model;
  }
  elements::Ellipsoid e;
  e.mean = Vec3f(20, 0, 0);
  e.set_covariance(Vec3(kSpread * kSpread, 1e8, 1e8).asDiagonal());
  e.hit.p = p;
  model.ellipsoids.push_back(e);
  return model;
}

/// Answers beams that pass through a cell each, all at one time.
std::vector<float> at_time(const elements::Model& model, double time_s, bool instrument = false) {
  BeamLog beams = beams_along_x(kBeams);
  for (size_t i = 0; i < kBeams; ++i) {
    beams.origin[i] = Vec3(0, 0.0077 + 0.5 * double(i), 0.0061);
    beams.time_s[i] = time_s;
  }
  const trace::World world(model, trace::Isa::kBest, trace::Draws::kSwaying);
  if (instrument) {
    const DynamicWorld still(world);
    const Reflection reflection(all_of("white_target"), 905e-9);
    Instrument thin = quiet_instrument();
    thin.sub_rays = {{}};
    EchoOptions options;
    options.sway_s = kSway;
    EchoMaker(still, reflection, thin, options).answer(0, beams);
    return beams.range_m;
  }
  Options options;
  options.sway_s = kSway;
  simulate(world, options, 0, beams);
  return beams.range_m;
}

double share_equal(const std::vector<float>& a, const std::vector<float>& b) {
  size_t equal = 0;
  for (size_t i = 0; i < a.size(); ++i) equal += a[i] == b[i];
  return double(equal) / double(a.size());
}

TEST(Wind, MatterIsTheSameWithAProbabilityThatFallsEvenlyOverTheCorrelationTime) {
  const elements::Model model = target(true, 0.5f);
  for (const bool instrument : {false, true}) {
    const std::vector<float> now = at_time(model, 1e9, instrument);
    for (const double later : {0.0, 0.1, 0.25, 0.4, 0.5, 2.0}) {
      const double same = std::max(0.0, 1 - later / kSway);
      // Other matter is equal where both let the beam pass: 1/4.
      EXPECT_NEAR(share_equal(now, at_time(model, 1e9 + later, instrument)), same + (1 - same) / 4,
                  5 * std::sqrt(0.25 / kBeams))
          << later;
    }
  }
}

TEST(Wind, TheMatterOfAnObjectThatMovesSwaysAsSlowlyInIt) {
  elements::Scene scene;
  scene.models = {target(false, 0), target(true, 0.5f)};
  scene.models[0].surface = {};
  scene.instances.resize(2);
  scene.instances[1].model = 1;
  const Trajectory stays({{0, {}}, {100, {}}});
  const DynamicWorld world(scene, {{1, stays}}, trace::Draws::kSwaying);
  Options options;
  options.sway_s = kSway;
  const auto at = [&](double time_s) {
    BeamLog beams = beams_along_x(kBeams);
    for (size_t i = 0; i < kBeams; ++i) {
      beams.origin[i] = Vec3(0, 0.0077 + 0.5 * double(i), 0.0061);
      beams.time_s[i] = time_s;
    }
    simulate(world, options, 0, beams);
    return beams.range_m;
  };
  const std::vector<float> now = at(50);
  for (const double later : {0.1, 0.25, 0.4, 2.0}) {
    const double same = std::max(0.0, 1 - later / kSway);
    EXPECT_NEAR(share_equal(now, at(50 + later)), same + (1 - same) / 4,
                5 * std::sqrt(0.25 / kBeams))
        << later;
  }
}

TEST(Wind, EveryInstantHasTheHitRateAndTheSpreadOfStillMatter) {
  for (const double time_s : {0.0, 0.33, 7.77, 1e9}) {
    double hits = 0, sum = 0, square = 0;
    for (const float r : at_time(target(true, 0.3f), time_s)) {
      if (r == kMiss) continue;
      const double d = double(r) - 20;
      ++hits, sum += d, square += d * d;
    }
    EXPECT_NEAR(hits / kBeams, 0.3, 5 * std::sqrt(0.21 / kBeams));
    EXPECT_NEAR(sum / hits, 0, 5 * kSpread / std::sqrt(hits));
    EXPECT_NEAR(std::sqrt(square / hits), kSpread, 5 * kSpread / std::sqrt(2 * hits));
  }
}

TEST(Wind, TrianglesStandStill) {
  const elements::Model model = target(false, 0.5f);
  EXPECT_EQ(share_equal(at_time(model, 3), at_time(model, 99)), 1);
}

TEST(Wind, AWorldAndItsCorrelationTimeBelongTogether) {
  const elements::Model model = target(true, 0.5f);
  BeamLog beams = beams_along_x(1);
  Options options;
  EXPECT_THROW(
      simulate(trace::World(model, trace::Isa::kBest, trace::Draws::kSwaying), options, 0, beams),
      std::invalid_argument);
  options.sway_s = 1;
  EXPECT_THROW(simulate(trace::World(model), options, 0, beams), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::simulate
