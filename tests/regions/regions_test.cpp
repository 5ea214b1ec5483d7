// Tests of worlds of regions: whatever of them is open, beams have the answers of the whole world,
// to the bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "ball_scanner.hpp"
#include "io/temporary.hpp"
#include "region_worlds.hpp"
#include "underbrush/calibrate/observed_space.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/hash.hpp"
#include "underbrush/pipeline/score_json.inl"
#include "underbrush/pipeline/score_logs.hpp"
#include "underbrush/pipeline/simulate_log.hpp"
#include "underbrush/regions/cut.hpp"
#include "underbrush/regions/reach.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::regions {
namespace {

using namespace test;

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

TEST(Regions, AModelAnswersAsIfItWereWhole) {
  const io::TemporaryFolder folder;
  const pipeline::World whole = world_of(whole_model());
  EXPECT_EQ(write_world(folder / "world", whole.scene, whole.info, kSide, "{}"), 35u);
  const BeamLog beams = drive(whole.scene.models[0].origin);
  // With little memory, regions are closed and the beams are answered in smaller parts.
  expect_same_answers(folder / "world", whole, beams, "2GiB");
  expect_same_answers(folder / "world", whole, beams, "400KiB");
}

TEST(Regions, TheirSideFollowsTheNumberOfElements) {
  // An ellipsoid in the middle of each square of 16 m of a field of 128 m by 128 m, n times.
  const auto side = [](size_t n) {
    elements::Scene scene;
    elements::Model& model = scene.models.emplace_back();
    model.origin = Vec3(512, -1024, 3);
    for (size_t k = 0; k < 64 * n; ++k) {
      elements::Ellipsoid& e = model.ellipsoids.emplace_back();
      e.mean = Vec3f(16 * float(k % 8) + 8, 16 * float(k / 8 % 8) + 8, 0);
    }
    return side_by_elements(scene);
  };
  EXPECT_EQ(side(1), 1024);
  EXPECT_EQ(side(kMostOfRegion / 64), 1024);
  EXPECT_EQ(side(kMostOfRegion / 64 + 1), 64);
  EXPECT_EQ(side(kMostOfRegion / 16), 64);
  EXPECT_EQ(side(kMostOfRegion / 16 + 1), 32);
}

TEST(Regions, ASceneAnswersAsIfItWereWhole) {
  const io::TemporaryFolder folder;
  pipeline::World whole = world_of_scene();
  write_world(folder / "world", whole.scene, whole.info, kSide, "{}");
  const BeamLog beams = drive(whole.scene.models[0].origin);
  expect_same_answers(folder / "world", whole, beams, "300KiB");
}

TEST(Regions, WhatMovesMovesInAllOfThem) {
  const io::TemporaryFolder folder;
  pipeline::World whole = world_of_scene();
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

TEST(Regions, WhatIsAddedMovesInAllOfThem) {
  const io::TemporaryFolder folder;
  for (const bool is_scene : {false, true}) {
    const pipeline::World whole = is_scene ? world_of_scene() : world_of(whole_model());
    write_world(folder / "world", whole.scene, whole.info, kSide, "{}");
    const Vec3 origin = whole_model().origin;
    const BeamLog beams = drive(origin);
    const auto with_movers = [&](pipeline::World world) {
      for (const double y : {14., 22.}) {
        Model ball;
        ball.ellipsoids.emplace_back().set_covariance(Mat3::Identity());
        ball.ellipsoids[0].hit.p = 0.9F;
        Pose begin, end;
        begin.translation = origin + Vec3(5, y, 2);
        end.translation = origin + Vec3(55, y, 2);
        pipeline::add_mover(world, std::move(ball), Trajectory({{0, begin}, {0.4, end}}), "");
      }
      return world;
    };
    pipeline::SimulateOptions options;
    options.element_ids = true;
    options.tau = 2.5;
    options.memory = "300KiB";
    const BeamLog expected = answers(with_movers(whole), beams, options);
    const auto* instance = std::get_if<std::vector<uint32_t>>(&expected.extra.at("instance"));
    ASSERT_NE(instance, nullptr);
    const uint32_t last = is_scene ? 202 : 2;
    EXPECT_GT(std::ranges::count(*instance, last), 5);
    expect_same(answers(with_movers(pipeline::open_world(folder / "world")), beams, options),
                expected);
  }
}

TEST(Regions, WaveformsAreThoseOfTheWhole) {
  const io::TemporaryFolder folder;
  const pipeline::World whole = world_of_scene();
  write_world(folder / "world", whole.scene, whole.info, kSide, "{}");
  const BeamLog beams = drive(whole_model().origin);
  const auto waveforms = [&](pipeline::World world) {
    std::vector<simulate::BeamWaveform> all;
    pipeline::SimulateOptions options;
    options.memory = "300KiB";
    options.instrument.super_sample = "5";
    options.waveform = {10, 200};
    options.on_waveforms = [&](std::vector<simulate::BeamWaveform> taken) {
      std::ranges::move(taken, std::back_inserter(all));
    };
    answers(std::move(world), beams, options);
    return all;
  };
  const auto expected = waveforms(whole), found = waveforms(pipeline::open_world(folder / "world"));
  ASSERT_EQ(expected.size(), 200u);
  ASSERT_EQ(found.size(), expected.size());
  for (size_t k = 0; k < found.size(); ++k) {
    EXPECT_EQ(found[k].beam, expected[k].beam);
    EXPECT_EQ(found[k].signal, expected[k].signal);
    EXPECT_EQ(found[k].echo_m, expected[k].echo_m);
  }
}

TEST(Regions, ScoresAreThoseOfTheWhole) {
  const io::TemporaryFolder folder;
  for (const bool is_scene : {false, true}) {
    const pipeline::World whole = is_scene ? world_of_scene() : world_of(whole_model());
    write_world(folder / "world", whole.scene, whole.info, kSide, "{}");
    const BeamLog beams = drive(whole_model().origin);
    pipeline::SimulateOptions options;
    const BeamLog real = answers(whole, beams, options);
    options.seed = 2;
    const BeamLog simulated = answers(whole, beams, options);
    const auto score = [&](pipeline::World world, const std::string& memory) {
      MemorySource a(real, 1500), b(simulated, 700);
      const pipeline::TracedWorld traced(std::move(world));
      return pipeline::score_log(a, b, &traced, {.memory = memory});
    };
    const auto text = [](const metrics::Score& s) {
      return pipeline::json_of_log_score({"s", s, {}, {}}).dump();
    };
    const metrics::Score expected = score(whole, regions::kMemory);
    EXPECT_LT(expected.all.nll_per_beam, 10);
    for (const char* memory : {"2GiB", "300KiB"}) {
      const metrics::Score found = score(pipeline::open_world(folder / "world"), memory);
      EXPECT_EQ(text(found), text(expected));
      EXPECT_EQ(found.all.nll_per_beam, expected.all.nll_per_beam);
      EXPECT_EQ(found.all.crps_m, expected.all.crps_m);
    }
    EXPECT_THROW(score(pipeline::open_world(folder / "world"), "20KiB"), DataError);
  }
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
  options.tau = 3.5;  // that of the model is 3
  EXPECT_THROW(answers(pipeline::open_world(folder / "world"), beams, options),
               std::invalid_argument);
}

TEST(Regions, ARegionThatWasChangedIsNamed) {
  const io::TemporaryFolder folder;
  const std::filesystem::path path = folder / "world";
  const pipeline::World whole = world_of(whole_model());
  write_world(path, whole.scene, whole.info, kSide, "{}");
  const WorldFolder read(path), unread(path);
  const std::filesystem::path region = path / folder_of(read.index().regions[1].square);
  const uint32_t zero = 0, one = 1;
  read.part({&one, 1});
  // A digit of the manifest that changes no element.
  std::string manifest = read_file(region / "model.json");
  manifest.replace(manifest.find("\"tau\": ") + 7, 1, "7");
  std::ofstream(region / "model.json") << manifest;
  EXPECT_NO_THROW(unread.part({&zero, 1}));
  try {
    unread.part({&one, 1});
    FAIL();
  } catch (const FormatError& e) {
    EXPECT_NE(std::string(e.what()).find(region.filename().string()), std::string::npos);
    EXPECT_NE(std::string(e.what()).find("hash differs"), std::string::npos);
  }
  EXPECT_NO_THROW(read.part({&one, 1}));  // Regions are checked once.
}

TEST(Regions, DamagedWorldsAreRefused) {
  const io::TemporaryFolder folder;
  const std::filesystem::path path = folder / "world";
  const pipeline::World whole = world_of(whole_model());
  write_world(path, whole.scene, whole.info, kSide, "{}");
  Index index = read_index(path);
  const std::filesystem::path first = path / folder_of(index.regions[0].square),
                              second = path / folder_of(index.regions[1].square);
  // Refused by the hash, and with a hash that agrees by the numbers.
  const auto expect_refused = [&] {
    EXPECT_THROW(WorldFolder(path).whole(), FormatError);
    index.regions[0].hash = io::hash_of(first);
    std::filesystem::remove(path / "index.json");
    write_index(path, index);
    EXPECT_THROW(WorldFolder(path).whole(), FormatError);
  };
  // The numbers of another region, and then that region twice.
  std::filesystem::rename(first / "numbers.ply", folder / "numbers.ply");
  expect_refused();
  std::filesystem::copy_file(second / "numbers.ply", first / "numbers.ply");
  expect_refused();
  std::filesystem::remove_all(first);
  std::filesystem::copy(second, first, std::filesystem::copy_options::recursive);
  expect_refused();
  std::ofstream(path / "index.json") << R"({"format": "underbrush-world", "version": 2})";
  EXPECT_THROW(read_index(path), FormatError);
  EXPECT_THROW(write_world(folder.path(), whole.scene, whole.info, kSide, "{}"), IoError);
}

}  // namespace
}  // namespace underbrush::regions
