#include <gtest/gtest.h>

#include "simulate/targets.hpp"
#include "trace/scenes.hpp"
#include "underbrush/core/linear.hpp"
#include "underbrush/sensor/angles.hpp"
#include "underbrush/sensor/pattern.hpp"

namespace underbrush::simulate {
namespace {

sensor::Sensor spinning() {
  sensor::Sensor s = sensor::load("velodyne-vlp16");
  s.max_range_m = 1000;
  s.min_range_m = 0;
  return s;
}

// The reference follows from the sensor's description alone and uses no pattern, pose or tracing
// code.
TEST(Motion, ASensorThatTurnsAndMovesPastAPlaneMeasuresTheAnalyticRanges) {
  const sensor::Sensor s = spinning();
  const double turn = 0.7, tilt = 0.2;  // rad/s about z; the sensor is tilted about y
  const Vec3 start(1, -4, 0.5), velocity(3, 11, -0.7);
  const Eigen::Quaterniond lean(Eigen::AngleAxisd(tilt, Vec3::UnitY()));
  const auto turned = [&](double t) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(turn * t, Vec3::UnitZ())) * lean;
  };
  const Trajectory path({{0, {turned(0), start}}, {0.5, {turned(0.5), start + 0.5 * velocity}}});
  const Vec3 normal = Vec3(1, 0.3, 0.1).normalized();
  const double distance = 12;
  elements::Model model;
  const Vec3 a = normal.unitOrthogonal(), b = normal.cross(a);
  add_sheet(model, distance * normal - 2000 * a - 2000 * b, 4000 * a, 4000 * b);
  BeamLog log = sensor::beams(s, path, 0, 0.3);
  simulate(trace::World(model), {}, 0, log);
  size_t hits = 0;
  double worst = 0, still = 0;
  for (size_t i = 0; i < log.size(); ++i) {
    const double t = log.time_s[i];
    const sensor::Channel& c = s.channels[log.ring[i]];
    const double azimuth =
        s.start_azimuth_rad + c.azimuth_rad + s.turn() * 2 * M_PI * s.rate_hz * t;
    const Vec3 local(std::cos(c.elevation_rad) * std::cos(azimuth),
                     std::cos(c.elevation_rad) * std::sin(azimuth), std::sin(c.elevation_rad));
    const Vec3 d = turned(t) * local, o = start + velocity * t + turned(t) * Vec3(0, 0, c.z_m);
    const double range = (distance - o.dot(normal)) / d.dot(normal);
    const double cosine = std::abs(d.dot(normal));
    if (range <= 0 || cosine < 0.1 || range > 200) continue;
    ASSERT_TRUE(log.is_hit(i)) << i;
    ++hits;
    // Directions are floats (6e-8), which at incidence θ gives 6e-8 R tan θ of range. The range is
    // a float, too, and vertices 2 km away are floats of 1e-4 m.
    worst = std::max(worst, std::abs(log.range_m[i] - range) / (range / cosine));
    const Vec3 d0 = turned(0) * local;
    still =
        std::max(still, std::abs(log.range_m[i] - (distance - start.dot(normal)) / d0.dot(normal)));
  }
  EXPECT_GT(hits, 20000u);
  EXPECT_LT(worst, 4e-7);  // neighbouring floats differ by 1.2e-7
  EXPECT_GT(still, 1);     // without motion, ranges would be metres off
}

elements::Scene two_sheets() {
  elements::Scene scene;
  elements::Model wall, target;
  add_wall(wall, 50);
  add_sheet(target, Vec3(0, -1, -1), Vec3(0, 2, 0), Vec3(0, 0, 2));
  target.origin = Vec3(7, 7, 7);  // has no effect in a scene
  scene.models = {wall, target};
  scene.instances.resize(2);
  scene.instances[1].model = 1;
  return scene;
}

TEST(Motion, ABeamMeetsAMovingObjectWhereItIsAtTheBeamsOwnTime) {
  const elements::Scene scene = two_sheets();
  // The object approaches at 20 m/s from 30 m while it turns about z, so that it is seen at x = 30
  // − 20 t.
  const double w = 0.5;
  const auto pose = [&](double t) {
    return Pose{Eigen::Quaterniond(Eigen::AngleAxisd(w * t, Vec3::UnitZ())),
                Vec3(30 - 20 * t, 0, 0)};
  };
  const DynamicWorld dynamic_world(scene, {{1, Trajectory({{0, pose(0)}, {1, pose(1)}})}});
  BeamLog beams = beams_along_x(1200);
  for (size_t i = 0; i < beams.size(); ++i) {
    beams.time_s[i] = double(i) / 1000;
    beams.origin[i].y() = 0.1;
  }
  Options options;
  options.element_ids = true;
  simulate(dynamic_world, options, 0, beams);
  for (size_t i = 0; i < beams.size(); ++i) {
    const double t = std::min(1.0, beams.time_s[i]);  // it stands still afterwards
    ASSERT_NEAR(beams.range_m[i], 30 - 20 * t - 0.1 * std::tan(w * t), 1e-5) << i;
  }
}

TEST(Motion, AWholeInstrumentSeesTheMoverAndItsIncidence) {
  const elements::Scene scene = two_sheets();
  const auto pose = [&](double t) {
    return Pose{Eigen::Quaterniond(Eigen::AngleAxisd(t, Vec3::UnitZ())), Vec3(20, 0, 0)};
  };
  const DynamicWorld dynamic_world(scene, {{1, Trajectory({{0, pose(0)}, {1, pose(1)}})}});
  Instrument instrument = quiet_instrument();
  instrument.beam.divergence_rad = {1e-4, 1e-4};
  const Reflection reflection(all_of("white_target"), 905e-9);
  BeamLog beams = beams_along_x(11);
  for (size_t i = 0; i < beams.size(); ++i) beams.time_s[i] = 0.1 * double(i);
  EchoMaker(dynamic_world, reflection, instrument, {}).answer(0, beams);
  ASSERT_EQ(beams.size(), 11u);
  for (size_t i = 0; i < 11; ++i) {
    EXPECT_NEAR(beams.range_m[i], 20, 2e-3);
    const double signal = 1e6 * 0.99 / 400 * std::cos(0.1 * double(i));
    EXPECT_NEAR(beams.intensity[i], signal, 0.003 * signal) << i;
  }
}

TEST(Motion, AMoverThatStandsIsTheInstanceItself) {
  elements::Scene scene;
  scene.models = {trace::random_model(3, 1000), trace::random_model(4, 1000)};
  for (elements::Model& m : scene.models) m.origin.setZero();
  scene.instances.resize(3);
  scene.instances[1].model = 1;
  scene.instances[1].scale = 0.7f;
  scene.instances[1].world_from_model = {
      Eigen::Quaterniond(Eigen::AngleAxisd(1, Vec3(1, 2, 3).normalized())), Vec3(4, -3, 1)};
  scene.instances[2].model = 1;
  scene.instances[2].world_from_model.translation = Vec3(-8, 2, 0);
  BeamLog beams = beams_along_x(20000);
  Stream random(8);
  for (Vec3f& d : beams.direction) {
    d = Vec3(random.normal(), random.normal(), random.normal()).normalized().cast<float>();
  }
  BeamLog moved = beams;
  Options options;
  options.element_ids = true;
  simulate(trace::World(scene), options, 0, beams);
  const Trajectory stands({{0, scene.instances[1].world_from_model}});
  simulate(DynamicWorld(scene, {{1, stands}}), options, 0, moved);
  size_t differ = 0;
  for (size_t i = 0; i < beams.size(); ++i) {
    if (beams.is_hit(i) != moved.is_hit(i) ||
        (beams.is_hit(i) && std::abs(beams.range_m[i] - moved.range_m[i]) > 1e-4)) {
      ++differ;
    }
  }
  EXPECT_LE(differ, 2u);  // beams can graze an element by less than the rounding
  EXPECT_EQ(column<uint32_t>(beams, "element").size(), beams.size());
}

TEST(Motion, ABeamAloneMeetsWhatItMeetsAmongOthers) {
  // Things that fly and turn about points beside them, and beams in all directions.
  elements::Scene scene;
  scene.models.push_back(trace::random_model(5, 200));
  scene.models[0].origin.setZero();
  scene.instances.resize(6);
  scene.instances[0].world_from_model.translation.z() = 1e4;
  std::vector<elements::Mover> movers;
  Stream random(9);
  const auto somewhere = [&](double far) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    return Vec3(far * x, far * y, far * z);
  };
  for (uint32_t k = 1; k < 6; ++k) {
    std::vector<StampedPose> poses;
    for (int j = 0; j < 4; ++j) {
      const Vec3 turn = somewhere(1), at = somewhere(30);
      poses.push_back({0.3 * j, {turn_between(Vec3::UnitX(), turn), at}});
    }
    movers.push_back({k, Trajectory(std::move(poses))});
  }
  const DynamicWorld world(scene, movers);
  BeamLog beams = beams_along_x(3000);
  for (size_t i = 0; i < beams.size(); ++i) {
    beams.time_s[i] = double(i) / 2500;
    beams.origin[i] = somewhere(0.5);
    const double turn = 0.004 * double(i);
    beams.direction[i] =
        Vec3f(float(std::cos(turn)), float(std::sin(turn)), float(i % 32) / 64 - 0.25F)
            .normalized();
  }
  BeamLog alone = beams;
  simulate(world, {}, 0, beams);
  size_t met = 0;
  for (size_t i = 0; i < beams.size(); ++i) {
    BeamLog one = alone.like();
    one.append(alone, i);
    simulate(world, {}, i, one);
    ASSERT_EQ(one.range_m[0], beams.range_m[i]) << i;
    met += beams.is_hit(i);
  }
  EXPECT_GT(met, 100u);
}

TEST(Motion, AMoverIsMetOnlyWhileItIsThere) {
  const elements::Scene scene = two_sheets();
  const Trajectory stands({{0, {Eigen::Quaterniond::Identity(), Vec3(20, 0, 0)}}});
  BeamLog beams = beams_along_x(40);
  for (size_t i = 0; i < beams.size(); ++i) beams.time_s[i] = double(i) / 10;
  simulate(DynamicWorld(scene, {{1, stands, 1, 3}}), {}, 0, beams);
  for (size_t i = 0; i < beams.size(); ++i) {
    EXPECT_NEAR(beams.range_m[i], i >= 10 && i < 30 ? 20 : 50, 1e-5) << i;
  }
}

TEST(Motion, WrongMoversAreRefused) {
  const elements::Scene scene = two_sheets();
  const Trajectory stands({{0, Pose{}}});
  EXPECT_THROW(DynamicWorld(scene, {{2, stands}}), std::invalid_argument);
  EXPECT_THROW(DynamicWorld(scene, {{1, Trajectory()}}), std::invalid_argument);
  EXPECT_THROW(DynamicWorld(scene, {{1, stands}, {1, stands}}), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::simulate
