// Tests of worlds of regions: whatever of them is open, beams have the answers of the whole world,
// to the bit.
#include <gtest/gtest.h>

#include <fstream>

#include "ball_scanner.hpp"
#include "io/temporary.hpp"
#include "underbrush/calibrate/observed_space.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/pipeline/simulate_log.hpp"
#include "underbrush/regions/cut.hpp"
#include "underbrush/regions/reach.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::regions {
namespace {

using elements::Model;

constexpr double kSide = 10;  // m

/// Adds hilly ground over [0, 60] × [0, 40] m, with hit probabilities and roughnesses of its own.
void add_ground(Model& model, Stream& random) {
  constexpr uint32_t kX = 31, kY = 21;
  elements::TriangleMesh& mesh = model.ground;
  for (uint32_t k = 0; k < kX * kY; ++k) {
    mesh.vertices.emplace_back(2.F * float(k % kX), 2.F * float(k / kX),
                               float(random.uniform(-0.3, 0.3)));
  }
  for (uint32_t k = 0; k < (kX - 1) * (kY - 1); ++k) {
    const uint32_t a = k / (kX - 1) * kX + k % (kX - 1), b = a + kX;
    mesh.triangles.push_back({a, a + 1, b + 1});
    mesh.triangles.push_back({a, b + 1, b});
  }
  for (size_t k = 0; k < mesh.size(); ++k) {
    mesh.hit.push_back({float(random.uniform(0.6, 1)), 1, 0});
    mesh.roughness.push_back(float(random.uniform(0, 0.05)));
    mesh.light.push_back({float(random.uniform(5, 50)), 1});
  }
  mesh.range_sigma_m = 0.02;
}

void add_ellipsoids(Model& model, size_t count, const Vec3& size_m, Stream& random) {
  for (size_t k = 0; k < count; ++k) {
    elements::Ellipsoid e;
    for (int d = 0; d < 3; ++d) e.mean[d] = float(random.uniform(0, size_m[d]));
    const Vec3 sigma(random.uniform(0.02, 0.4), random.uniform(0.02, 0.4), 0.3);
    e.set_covariance(sigma.cwiseAbs2().asDiagonal());
    e.hit.p = float(random.uniform(0.05, 0.6));
    e.label = uint32_t(k % 3);
    if (k % 4 == 0) e.density_per_m = float(random.uniform(0.2, 2));
    e.light = {float(random.uniform(5, 50)), 3};
    model.ellipsoids.push_back(e);
  }
}

/// A model in which every kind of element lies across the borders of regions.
Model whole_model() {
  Stream random(1);
  Model model;
  model.origin = Vec3(500007, -304, 12);
  model.tau = 3;
  add_ground(model, random);
  add_ellipsoids(model, 3000, Vec3(60, 40, 5), random);
  elements::TriangleMesh& wall = model.surface;
  wall.vertices = {{3, 20, 0}, {50, 20, 0}, {50, 20, 3}, {3, 20, 3}};
  wall.triangles = {{0, 1, 2}, {0, 2, 3}};
  wall.hit = {{0.7F, 1, 0}, {0.8F, 1, 0}};
  wall.light.resize(2);
  model.grain = {0.1, 0.2, {{1, 0.05}}};
  model.range_noise_m = 0.01;
  model.light.max_intensity = 100;
  model.light.range = {{0, 60}, {1, 0.5}};
  for (auto& g : model.light.incidence) g = {{0, 1}, {0.5, 1}};
  return model;
}

/// A scene of the model's ground and of plants, turned and scaled.
elements::Scene whole_scene(elements::SceneInfo& info) {
  Stream random(2);
  elements::Scene scene;
  const Model whole = whole_model();
  scene.models.push_back(whole.like());
  scene.models[0].ground = whole.ground;
  for (int k = 0; k < 3; ++k) {
    scene.models.emplace_back();
    add_ellipsoids(scene.models.back(), 60, Vec3(2, 2, 4), random);
  }
  scene.instances.emplace_back().world_from_model.translation = whole.origin;
  for (uint32_t k = 0; k < 200; ++k) {
    elements::Instance& i = scene.instances.emplace_back();
    i.world_from_model.translation =
        whole.origin + Vec3(random.uniform(0, 60), random.uniform(0, 40), 0);
    i.world_from_model.rotation =
        Eigen::Quaterniond(Eigen::AngleAxisd(random.uniform(-3, 3), Vec3::UnitZ()));
    i.scale = float(random.uniform(0.5, 1.5));
    i.model = 1 + k % 3;
  }
  info.names = {"ground", "a", "b", "c"};
  info.labels.assign(scene.instances.size(), elements::Class::kSmallTree);
  info.labels[0] = elements::Class::kGround;
  return scene;
}

/// The beams of a sensor that drives through the world and over its border.
BeamLog drive(const Vec3& origin, size_t beams = 4000) {
  Stream random(3);
  BeamLog log;
  log.info.sensor = "velodyne-hdl32e";
  log.info.max_range_m = 25;
  log.info.min_range_m = 0.5;
  log.info.has_misses = true;
  log.resize(beams);
  for (size_t i = 0; i < beams; ++i) {
    const double azimuth = random.uniform(0, 2 * M_PI), elevation = random.uniform(-0.4, 0.1);
    log.time_s[i] = 1e-4 * double(i);
    log.origin[i] = origin + Vec3(-30 + 100 * double(i) / double(beams), 18, 2);
    log.direction[i] = Vec3(std::cos(azimuth) * std::cos(elevation),
                            std::sin(azimuth) * std::cos(elevation), std::sin(elevation))
                           .cast<float>();
  }
  return log;
}

/// Expects equal columns, to the bit.
void expect_same(const BeamLog& a, const BeamLog& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(a.range_m, b.range_m);
  EXPECT_EQ(a.intensity, b.intensity);
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_EQ(a.extra, b.extra);
}

std::vector<pipeline::SimulateOptions> many_options() {
  std::vector<pipeline::SimulateOptions> all(6);
  all[0].element_ids = true;
  all[1].matter = "anew";
  all[2].sway_s = 0.3;
  all[2].intensity = "drawn";
  all[3].draw = "median";
  all[4].draw = "volumetric";
  all[4].beam = "random";
  all[4].grain_m = 0.3;
  all[5].instrument.super_sample = "5";
  all[5].element_ids = true;
  for (pipeline::SimulateOptions& o : all) o.seed = 7;
  return all;
}

BeamLog answers(pipeline::World world, const BeamLog& beams,
                const pipeline::SimulateOptions& options) {
  pipeline::change_world(world, options);
  const pipeline::TracedWorld traced(std::move(world), pipeline::matter_of(options));
  pipeline::Simulation simulation(traced, options, [](const char*) {
    sensor::Sensor s = sensor::load("velodyne-hdl32e");
    s.max_range_m = 25;
    return s;
  });
  MemorySource source(beams, 1500);
  return pipeline::simulate_log(simulation, source);
}

/// Expects that a world has the same answers by regions as in memory, with every option.
void expect_same_answers(const std::filesystem::path& path, const pipeline::World& whole,
                         const BeamLog& beams, const std::string& memory) {
  for (pipeline::SimulateOptions options : many_options()) {
    if (options.sway_s > 0 && whole.scene.instances.size() > 1) continue;
    options.memory = memory;
    const BeamLog expected = answers(whole, beams, options);
    size_t hits = 0;
    for (size_t i = 0; i < expected.size(); ++i) hits += expected.is_hit(i);
    EXPECT_GT(hits, expected.size() / 3);
    expect_same(answers(pipeline::open_world(path), beams, options), expected);
    expect_same(answers(pipeline::read_world(path), beams, options), expected);
  }
}

pipeline::World world_of(Model model) {
  pipeline::World world;
  world.scene.models.push_back(std::move(model));
  return world;
}

TEST(Regions, AModelAnswersAsIfItWereWhole) {
  const io::TemporaryFolder folder;
  const pipeline::World whole = world_of(whole_model());
  EXPECT_EQ(write_world(folder / "world", whole.scene, whole.info, kSide, "{}"), 35u);
  const BeamLog beams = drive(whole.scene.models[0].origin);
  // With little memory, regions are closed and the beams are answered in smaller parts.
  expect_same_answers(folder / "world", whole, beams, "2GiB");
  expect_same_answers(folder / "world", whole, beams, "400KiB");
}

TEST(Regions, ASceneAnswersAsIfItWereWhole) {
  const io::TemporaryFolder folder;
  pipeline::World whole;
  whole.scene = whole_scene(whole.info);
  write_world(folder / "world", whole.scene, whole.info, kSide, "{}");
  const BeamLog beams = drive(whole.scene.models[0].origin);
  expect_same_answers(folder / "world", whole, beams, "300KiB");
}

TEST(Regions, WhatMovesMovesInAllOfThem) {
  const io::TemporaryFolder folder;
  pipeline::World whole;
  whole.scene = whole_scene(whole.info);
  const Pose begin = whole.scene.instances[77].world_from_model;
  Pose end = begin;
  end.translation += Vec3(8, 5, 0);
  whole.info.movers.push_back({77, Trajectory({{0, begin}, {2, end}})});
  write_world(folder / "world", whole.scene, whole.info, kSide, "{}");
  const BeamLog beams = drive(whole.scene.models[0].origin, 4000);
  pipeline::SimulateOptions options;
  options.element_ids = true;
  options.memory = "300KiB";
  expect_same(answers(pipeline::open_world(folder / "world"), beams, options),
              answers(whole, beams, options));
}

TEST(Regions, KeyframesAndUnknownSpaceAnswerAsIfTheModelWereWhole) {
  const io::TemporaryFolder folder;
  const BeamLog beams = test::scanned({1.3, 3}, 100, 0.7);
  const BeamLog log = test::scanned(test::kDrive, 0, 0.7);
  MemorySource source(log);
  Model model = test::fitted(log, 1);
  calibrate::learn_observed_space(model, source, {});
  ASSERT_TRUE(model.keyframes && model.observed);
  const pipeline::World whole = world_of(std::move(model));
  write_world(folder / "world", whole.scene, whole.info, 4, "{}");
  pipeline::SimulateOptions options;
  for (const bool keyframes : {true, false}) {
    options.keyframes = keyframes;
    options.support = !keyframes;
    options.memory = "1500KiB";
    expect_same(answers(pipeline::open_world(folder / "world"), beams, options),
                answers(whole, beams, options));
  }
}

TEST(Regions, EveryElementThatABeamMeetsLiesInARegionThatItReaches) {
  const io::TemporaryFolder folder;
  const pipeline::World whole = world_of(whole_model());
  write_world(folder / "world", whole.scene, whole.info, kSide, "{}");
  const WorldFolder world(folder / "world");
  const BeamLog beams = drive(whole.scene.models[0].origin, 300);
  const trace::World traced(whole.scene.models[0]);
  size_t opened = 0;
  for (size_t i = 0; i < beams.size(); ++i) {
    const std::vector<uint32_t> open = reached(world.index(), beams, i, i + 1, 25, 0);
    opened += open.size();
    const WorldPart part = world.part(open);
    const Model& model = part.scene.models[0];
    std::vector<trace::Intersection> met;
    traced.all_intersections(beams.ray(i), {0, 25}, 25, met);
    for (const trace::Intersection& m : met) {
      const elements::ElementPlace at = model.place(m.element);
      const auto& numbers = model.part_of->numbers[size_t(at.kind)];
      ASSERT_LT(at.index, numbers.size());
      EXPECT_EQ(model.part_of->first(at.kind) + numbers[at.index], m.element);
    }
  }
  EXPECT_LT(double(opened), 0.3 * double(beams.size() * world.index().regions.size()));
}

TEST(Regions, MemoryForLessThanABeamIsRefused) {
  const io::TemporaryFolder folder;
  const pipeline::World whole = world_of(whole_model());
  write_world(folder / "world", whole.scene, whole.info, kSide, "{}");
  pipeline::SimulateOptions options;
  options.memory = "20KiB";
  const BeamLog beams = drive(whole.scene.models[0].origin);
  EXPECT_THROW(answers(pipeline::open_world(folder / "world"), beams, options), DataError);
  for (const char* text : {"", "GiB", "-1GiB", "2 GB", "0", "nan"}) {
    options.memory = text;
    EXPECT_THROW(answers(pipeline::open_world(folder / "world"), beams, options),
                 std::invalid_argument)
        << text;
  }
  options = {};
  options.tau = 2;
  EXPECT_THROW(answers(pipeline::open_world(folder / "world"), beams, options),
               std::invalid_argument);
}

TEST(Regions, DamagedWorldsAreRefused) {
  const io::TemporaryFolder folder;
  const std::filesystem::path path = folder / "world";
  const pipeline::World whole = world_of(whole_model());
  write_world(path, whole.scene, whole.info, kSide, "{}");
  const WorldFolder world(path);
  const std::filesystem::path first = path / folder_of(world.index().regions[0].square),
                              second = path / folder_of(world.index().regions[1].square);
  // The numbers of another region, and then that region twice.
  std::filesystem::rename(first / "numbers.ply", folder / "numbers.ply");
  EXPECT_THROW(world.whole(), FormatError);
  std::filesystem::copy_file(second / "numbers.ply", first / "numbers.ply");
  EXPECT_THROW(world.whole(), FormatError);
  std::filesystem::remove_all(first);
  std::filesystem::copy(second, first, std::filesystem::copy_options::recursive);
  EXPECT_THROW(world.whole(), FormatError);
  std::ofstream(path / "index.json") << R"({"format": "underbrush-world", "version": 2})";
  EXPECT_THROW(read_index(path), FormatError);
  EXPECT_THROW(write_world(folder.path(), whole.scene, whole.info, kSide, "{}"), IoError);
}

}  // namespace
}  // namespace underbrush::regions
