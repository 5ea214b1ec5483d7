#include "underbrush/simulate/learnt_light.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "underbrush/core/parallel.hpp"
#include "underbrush/simulate/echoes.hpp"
#include "underbrush/simulate/simulate.hpp"

namespace underbrush::simulate {
namespace {

/// Makes a wall across x = 10 that is turned by 60° about z, with light.
elements::Model wall() {
  elements::Model model;
  model.sensor = "velodyne-hdl64e";
  const double c = std::cos(std::numbers::pi / 3), s = std::sin(std::numbers::pi / 3);
  for (const auto& [along, z] : {std::pair{-50., -50.}, {50., -50.}, {0., 80.}}) {
    model.surface.vertices.push_back(Vec3(10 - along * s, along * c, z).cast<float>());
  }
  model.surface.triangles = {{0, 1, 2}};
  model.surface.hit.resize(1);
  model.surface.light = {{40, 10}};
  model.light.max_intensity = 255;
  model.light.range = {{5, 15}, {1.5, 0.5}};
  model.light.incidence[0] = {{0, 1}, {0.2, 1.2}};
  model.light.ring = {1, 2};
  return model;
}

BeamLog beams(size_t n, const std::string& sensor) {
  BeamLog log;
  log.info.sensor = sensor;
  log.resize(n);
  for (size_t i = 0; i < n; ++i) log.ring[i] = uint16_t(i % 2);
  return log;
}

BeamLog answered(const elements::Model& model, BeamLog log, IntensityDraw draw) {
  Options options;
  options.intensity = draw;
  simulate(trace::World(model), options, 0, log);
  return log;
}

TEST(LearntLight, IsReflectanceTimesRangeIncidenceAndRing) {
  const BeamLog log = answered(wall(), beams(2, "velodyne-hdl64e"), IntensityDraw::kMean);
  ASSERT_NEAR(log.range_m[0], 10, 1e-4);
  EXPECT_NEAR(log.intensity[0], 40 * 1.0 * 0.7 * 1, 1e-3);  // cos 60° = 0.5 lies half way
  EXPECT_NEAR(log.intensity[1], 40 * 1.0 * 0.7 * 2, 1e-3);
}

TEST(LearntLight, OfAnInstrumentIsThatOfAThinRayInTheUnitOfTheLog) {
  const elements::Model model = wall();
  const trace::World world(model);
  const DynamicWorld dynamic_world(world);
  const Reflection reflection(radiometry::load_materials(), 905e-9);
  Instrument instrument;
  instrument.beam = sensor::round_beam(0.002, 0);
  instrument.sub_rays = sensor::spread_sub_rays(instrument.beam, 9);
  instrument.receiver.noise_sigma = 0;
  EchoOptions options;
  options.learnt_light = IntensityDraw::kMean;
  BeamLog log = beams(2, "velodyne-hdl64e");
  EchoMaker(dynamic_world, reflection, instrument, options).answer(0, log);
  ASSERT_EQ(log.size(), 2u);
  EXPECT_NEAR(log.intensity[0], 40 * 0.7, 0.05);
  EXPECT_NEAR(log.intensity[1], 40 * 0.7 * 2, 0.1);
}

TEST(LearntLight, OfAnotherSensorHasNoGainsOfChannels) {
  const BeamLog log = answered(wall(), beams(2, "ouster-os1-64"), IntensityDraw::kMean);
  EXPECT_NEAR(log.intensity[1], 40 * 0.7, 1e-3);
}

TEST(LearntLight, IsDrawnWithTheSpreadOfTheElementForAnyNumberOfThreads) {
  const BeamLog log = answered(wall(), beams(40000, "ouster-os1-64"), IntensityDraw::kDrawn);
  double mean = 0, square = 0;
  for (const float x : log.intensity) mean += x, square += double(x) * x;
  mean /= double(log.size());
  EXPECT_NEAR(mean, 28, 0.15);
  EXPECT_NEAR(std::sqrt(square / double(log.size()) - mean * mean), 7, 0.15);
  set_threads(1);
  EXPECT_EQ(answered(wall(), beams(40000, "ouster-os1-64"), IntensityDraw::kDrawn).intensity,
            log.intensity);
  set_threads(0);
}

TEST(LearntLight, IsNeverBrighterThanTheLog) {
  elements::Model model = wall();
  model.light.max_intensity = 30;
  const BeamLog log = answered(model, beams(1000, "ouster-os1-64"), IntensityDraw::kDrawn);
  EXPECT_EQ(*std::max_element(log.intensity.begin(), log.intensity.end()), 30);
}

TEST(LearntLight, OfAModelWithoutIsZeroAndRangesStayTheSame) {
  elements::Model model = wall();
  const BeamLog lit = answered(model, beams(100, "ouster-os1-64"), IntensityDraw::kDrawn);
  model.light = {};
  model.surface.light.clear();
  const BeamLog dark = answered(model, beams(100, "ouster-os1-64"), IntensityDraw::kDrawn);
  EXPECT_EQ(dark.range_m, lit.range_m);
  EXPECT_EQ(dark.intensity, std::vector<float>(100, 0.0f));
}

/// Makes level ground in x < 0 of reflectance 40 and a bush of reflectance 100. Beyond, space is
/// unknown, and dense at a height above the ground.
elements::Model half_known(double height_m) {
  elements::Model model;
  model.ground.vertices = {{-20, -20, 0}, {0, -20, 0}, {0, 20, 0}, {-20, 20, 0}};
  model.ground.triangles = {{0, 1, 2}, {0, 2, 3}};
  model.ground.hit.resize(2);
  model.ground.light = {{40, 10}, {40, 10}};
  elements::Ellipsoid bush;
  bush.mean = Vec3f(-15, 0, 1);
  bush.set_covariance(0.01 * Mat3::Identity());
  bush.light = {100, 20};
  model.ellipsoids = {bush};
  model.light.max_intensity = 255;
  model.light.range = {{5, 15}, {1.5, 0.5}};
  model.light.incidence[0] = {{0, 1}, {0.2, 1.2}};
  auto space = std::make_shared<elements::ObservedSpace>();
  space->density_per_m[elements::ObservedSpace::height_interval(height_m)].fill(50);
  model.observed = space;
  return model;
}

TEST(LearntLight, OfUnknownSpaceIsThatOfGroundNearItAndElseOfEllipsoids) {
  BeamLog log = beams(1, "");
  log.origin[0] = Vec3(10, 0, 12);
  log.direction[0] = -Vec3f::UnitZ();
  const auto response = [&](const BeamLog& answer) {
    return std::lerp(1.5, 0.5, (double(answer.range_m[0]) - 5) / 10);
  };
  const BeamLog high = answered(half_known(1.5), log, IntensityDraw::kMean);
  ASSERT_TRUE(high.is_hit(0));
  EXPECT_NEAR(high.intensity[0], 100 * response(high), 1e-3);
  const BeamLog low = answered(half_known(0.25), log, IntensityDraw::kMean);
  ASSERT_TRUE(low.is_hit(0));
  EXPECT_NEAR(low.intensity[0], 40 * 1.2 * response(low), 1e-3);
}

TEST(LearntLight, TurnsWithItsInstance) {
  elements::Scene scene;
  scene.models = {wall()};
  scene.models[0].sensor.clear();
  scene.instances.resize(1);
  scene.instances[0].world_from_model.rotation =
      Eigen::AngleAxisd(-std::numbers::pi / 3, Vec3::UnitZ());
  BeamLog log = beams(1, "");
  simulate(DynamicWorld(scene, {}), {}, 0, log);
  ASSERT_NEAR(log.range_m[0], 5, 1e-4);  // the distance of the wall's plane
  EXPECT_NEAR(log.intensity[0], 40 * 1.5 * 1.2, 1e-3);
}

}  // namespace
}  // namespace underbrush::simulate
