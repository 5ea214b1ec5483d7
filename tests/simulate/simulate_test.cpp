#include "underbrush/simulate/simulate.hpp"

#include <gtest/gtest.h>

#include <array>

#include "trace/scenes.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/simulate/footprint.hpp"

namespace underbrush::simulate {
namespace {

elements::Model one_ellipsoid(float p, double sigma) {
  elements::Model model;
  model.tau = 3;
  elements::Ellipsoid e;
  e.mean = Vec3f(20, 0, 0);
  e.set_covariance(sigma * sigma * Mat3::Identity());
  e.hit.p = p;
  e.label = 7;
  model.ellipsoids.push_back(e);
  return model;
}

BeamLog beams_along_x(size_t n) {
  BeamLog log;
  log.info.max_range_m = 60;
  log.info.min_range_m = 1;
  log.resize(n);
  return log;
}

TEST(Simulate, HasTheHitProbabilityAndTheRangeDistributionOfItsElement) {
  const elements::Model model = one_ellipsoid(0.4f, 0.5);
  const trace::World world(model);
  BeamLog beams = beams_along_x(100000);
  simulate(world, {}, 0, beams);
  double n = 0, mean = 0, square = 0;
  for (size_t i = 0; i < beams.size(); ++i) {
    if (!beams.is_hit(i)) continue;
    ++n;
    mean += beams.range_m[i];
    square += (beams.range_m[i] - 20.0) * (beams.range_m[i] - 20.0);
  }
  EXPECT_NEAR(n / double(beams.size()), 0.4, 0.008);
  EXPECT_NEAR(mean / n, 20, 0.01);
  EXPECT_NEAR(square / n, 0.25, 0.006);
}

TEST(Simulate, VolumetricDrawsArePointsOfTheGaussianOffTheBeam) {
  const elements::Model model = one_ellipsoid(1, 0.5);
  const trace::World world(model);
  BeamLog beams = beams_along_x(50000);
  Options options;
  options.draw = RangeDraw::kVolumetric;
  simulate(world, options, 0, beams);
  Vec3 square = Vec3::Zero();
  for (size_t i = 0; i < beams.size(); ++i) {
    const Vec3 d = beams.end_point(i) - Vec3(20, 0, 0);
    square += d.cwiseAbs2() / double(beams.size());
  }
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(square[k], 0.25, 0.01) << k;
}

TEST(Simulate, OfASceneSaysWhichInstanceStoppedABeam) {
  elements::Scene scene;
  scene.models = {elements::Model(), one_ellipsoid(1, 0.1)};
  scene.models[0].max_range_m = 60;
  scene.instances.resize(3);
  for (uint32_t k = 1; k < 3; ++k) {
    scene.instances[k].model = 1;
    scene.instances[k].world_from_model.translation = Vec3(0, 5.0 * k, 0);
  }
  const trace::World world(scene);
  BeamLog beams = beams_along_x(3);
  for (size_t i = 0; i < 3; ++i) beams.origin[i] = Vec3(0, 5.0 * double(i), 0);
  beams.extra["instance"] = std::vector<uint8_t>{9, 9, 9};  // a column of the log that is answered
  Options options;
  options.instance_labels = {elements::Class::kGround, elements::Class::kLowShrub,
                             elements::Class::kLargeTree};
  simulate(world, options, 0, beams);
  EXPECT_EQ(std::get<std::vector<uint8_t>>(beams.extra.at("instance"))[0], 9);
  options.element_ids = true;
  simulate(world, options, 0, beams);
  EXPECT_EQ(std::get<std::vector<uint32_t>>(beams.extra.at("instance")),
            (std::vector<uint32_t>{0, 1, 2}));
  EXPECT_EQ(std::get<std::vector<uint16_t>>(beams.extra.at("element_class")),
            (std::vector<uint16_t>{0, uint16_t(elements::Class::kLowShrub),
                                   uint16_t(elements::Class::kLargeTree)}));
  EXPECT_FALSE(beams.is_hit(0));
}

TEST(Simulate, AMaximumRangeOfItsOwnReplacesThatOfTheBeams) {
  const elements::Model model = one_ellipsoid(1, 0.1);  // 20 m away
  const trace::World world(model);
  Options options;
  for (const double max_range_m : {0.0, 15.0, 25.0}) {
    BeamLog beams = beams_along_x(1);
    options.max_range_m = max_range_m;
    simulate(world, options, 0, beams);
    EXPECT_EQ(beams.is_hit(0), max_range_m != 15) << max_range_m;
  }
  BeamLog beams = beams_along_x(1);
  beams.info.max_range_m = 15;
  options.max_range_m = 25;
  simulate(world, options, 0, beams);
  EXPECT_TRUE(beams.is_hit(0));
}

TEST(Simulate, RangeNoiseAddsItsVariance) {
  const elements::Model model = one_ellipsoid(1, 0.1);
  const trace::World world(model);
  BeamLog beams = beams_along_x(50000);
  Options options;
  options.range_noise_m = 0.3;
  simulate(world, options, 0, beams);
  double square = 0;
  for (float r : beams.range_m) square += (r - 20.0) * (r - 20.0) / double(beams.size());
  EXPECT_NEAR(square, 0.01 + 0.09, 0.003);
}

TEST(Simulate, GivesTheSameBitsForAnyThreadsAndChunksAndOthersForAnotherSeed) {
  const elements::Model model = trace::random_model(3, 2000);
  const trace::World world(model);
  Stream random(5);
  BeamLog beams;
  beams.resize(10000);
  for (size_t i = 0; i < beams.size(); ++i) {
    const Ray ray = trace::random_ray(random, model);
    beams.origin[i] = ray.origin;
    beams.direction[i] = ray.direction.cast<float>();
    beams.scan[i] = uint32_t(i / 1000);
  }
  Options options;
  options.element_ids = true;
  BeamLog one = beams, two = beams, parts, other = beams;
  set_threads(1);
  simulate(world, options, 0, one);
  set_threads(2);
  simulate(world, options, 0, two);
  set_threads(0);
  for (size_t at = 0; at < beams.size(); at += 777) {
    BeamLog part;
    part.info = beams.info;
    part.append(beams, at, std::min(beams.size(), at + 777));
    simulate(world, options, at, part);
    parts.append(part, 0, part.size());
  }
  options.seed = 2;
  simulate(world, options, 0, other);
  EXPECT_EQ(one.range_m, two.range_m);
  EXPECT_EQ(one.range_m, parts.range_m);
  EXPECT_EQ(one.extra, two.extra);
  EXPECT_NE(one.range_m, other.range_m);
}

TEST(Simulate, NamesTheElementThatStoppedTheBeam) {
  const elements::Model model = one_ellipsoid(0.5f, 0.2);
  const trace::World world(model);
  BeamLog beams = beams_along_x(100);
  Options options;
  options.element_ids = true;
  simulate(world, options, 0, beams);
  const auto& element = std::get<std::vector<uint32_t>>(beams.extra.at("element"));
  const auto& label = std::get<std::vector<uint16_t>>(beams.extra.at("element_class"));
  for (size_t i = 0; i < beams.size(); ++i) {
    EXPECT_EQ(element[i], beams.is_hit(i) ? 0u : trace::Intersection::kNone);
    EXPECT_EQ(label[i], beams.is_hit(i) ? 7 : 0);
  }
}

TEST(Simulate, RandomRaysMeetWhatTheConeMeets) {
  // A wall that ends at y = 0 covers half of the beam's disc at 10 m, so half of the beams return.
  elements::Model model;
  model.surface.vertices = {{10, 0, -5}, {10, 5, -5}, {10, 5, 5}, {10, 0, 5}};
  model.surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  model.surface.hit.resize(2);
  const trace::World world(model);
  BeamLog beams = beams_along_x(40000);
  for (Vec3& o : beams.origin) o.y() = 0.001;
  const auto share = [&](const Options& options) {
    simulate(world, options, 0, beams);
    double hits = 0;
    for (size_t i = 0; i < beams.size(); ++i) {
      hits += beams.is_hit(i);
      // the reported direction stays that of the axis
      EXPECT_EQ(beams.direction[i], Vec3f::UnitX());
    }
    return hits / double(beams.size());
  };
  EXPECT_EQ(share({}), 1);
  Options options;
  options.random_ray = sensor::round_beam(0.002, 0.01);
  // The chord is 1 mm from the middle of a disc of 15 mm radius.
  const double x = 1.0 / 15, below = (std::acos(x) - x * std::sqrt(1 - x * x)) / M_PI;
  EXPECT_NEAR(share(options), 1 - below, 0.01);
  options.random_ray->encoder_step_rad = -1;
  EXPECT_THROW(share(options), std::invalid_argument);
}

TEST(Footprint, TrueAzimuthLiesEvenlyWithinTheEncodersStep) {
  // A thin beam points 2 cm inside the edge of a wall at 10 m, where the step is ±5 cm.
  elements::Model model;
  model.surface.vertices = {{10, 0, -5}, {10, 5, -5}, {10, 5, 5}, {10, 0, 5}};
  model.surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  model.surface.hit.resize(2);
  const trace::World world(model);
  BeamLog beams = beams_along_x(20000);
  for (Vec3& o : beams.origin) o.y() = 0.02;
  FootprintOptions options;
  options.shape = sensor::round_beam(0, 0);
  options.sub_rays = 1;
  options.shape.encoder_step_rad = 2 * std::atan(0.005);
  const std::vector<elements::Class> label(model.size(), elements::Class::kUnknown);
  scan(world, label, options, 0, beams);
  double hits = 0;
  for (size_t i = 0; i < beams.size(); ++i) hits += beams.is_hit(i) / double(beams.size());
  EXPECT_NEAR(hits, 0.7, 0.01);
}

// An instance gives the answers of its elements, moved to its place.
TEST(Simulate, AnswersFromTheInstancesOfAScene) {
  elements::Model tree = one_ellipsoid(1, 0.5);
  tree.ellipsoids[0].mean = Vec3f(0, 0, 2);
  elements::Scene scene;
  scene.models = {elements::Model{}, tree};
  scene.instances.resize(3);
  scene.instances[1] = {{Eigen::Quaterniond::Identity(), Vec3(20, 0, -2)}, 1, 1};
  scene.instances[2] = {
      {Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Vec3::UnitZ())), Vec3(40, 0, -4)}, 2, 1};
  const trace::World world(scene);
  for (const RangeDraw draw : {RangeDraw::kOnRay, RangeDraw::kVolumetric}) {
    for (const auto& [from_m, at_m, sigma] :
         {std::array{0.0, 20.0, 0.5}, std::array{30.0, 40.0, 1.0}}) {
      BeamLog beams = beams_along_x(20000);
      for (Vec3& o : beams.origin) o.x() = from_m;
      Options options;
      options.draw = draw;
      options.element_ids = true;
      simulate(world, options, 0, beams);
      double mean = 0, square = 0;
      for (size_t i = 0; i < beams.size(); ++i) {
        ASSERT_TRUE(beams.is_hit(i));
        const Vec3 d = beams.end_point(i) - Vec3(at_m, 0, 0);
        mean += d.x() / 20000;
        square += d.x() * d.x() / 20000;
      }
      EXPECT_NEAR(mean, 0, 0.03);
      EXPECT_NEAR(square, sigma * sigma, 0.05);
      EXPECT_EQ(std::get<std::vector<uint16_t>>(beams.extra.at("element_class"))[5], 7);
    }
  }
}

}  // namespace
}  // namespace underbrush::simulate
