#include "underbrush/osi/chain.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "data.hpp"
#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/osi/objects.hpp"
#include "underbrush/osi/read.hpp"
#include "underbrush/osi/replay.hpp"
#include "underbrush/osi/static_data.hpp"
#include "underbrush/osi/trace.hpp"
#include "underbrush/osi/write.hpp"

namespace underbrush {
namespace {

using testing::HasSubstr;

osi::MovingObject car(uint64_t id, double x, double y, double vx) {
  osi::MovingObject m;
  m.id = id;
  m.type = 2;
  m.vehicle_type = 4;
  m.base.dimension_m = Vec3(4.6, 1.8, 1.5);
  m.base.position_m = Vec3(x, y, 0.75);
  m.base.roll_pitch_yaw = Vec3::Zero();
  m.base.velocity_m_s = Vec3(vx, 0, 0);
  m.centre_to_rear_m = Vec3(-1.4, 0, -0.45);
  return m;
}

// The host at 10 m/s, and 15 m in front of it a car at 12 m/s.
osi::SensorView drive(int k, bool with_car = true) {
  const double t = 0.08 * k;
  osi::SensorView v;
  v.version = osi::Version{};
  v.timestamp = osi::Timestamp::of(t + 0.08);
  v.sensor_id = 4;
  v.host_vehicle_id = 0;
  v.truth.emplace();
  v.truth->timestamp = v.timestamp;
  v.truth->moving = {car(0, 10 * t, 0, 10)};
  if (with_car) v.truth->moving.push_back(car(1, 15 + 12 * t, 0.4, 12));
  std::string bytes;
  osi::write(v, bytes);
  return osi::read_sensor_view(bytes, "drive");
}

osi::ChainFile chain_of(std::initializer_list<const char*> names) {
  osi::ChainFile file;
  for (const char* name : names) file.strategies.push_back({name, "", {}, "test", name});
  file.set("tracer", "sensor", "ibeo-lux-2010");
  file.set("tracer", "x_m", "3.7");
  file.set("tracer", "z_m", "0.3");
  file.set("front_end", "sensor", "ibeo-lux-2010");
  return file;
}

osi::ChainFile whole() {
  return chain_of({"tracer", "front_end", "alignment", "tracking", "classification", "grid"});
}

osi::SensorData run(osi::Chain& chain, const osi::SensorView& view) {
  return chain.step(std::make_shared<osi::SensorView>(view));
}

std::string bytes_of(const osi::SensorData& data) {
  std::string out;
  osi::write(data, out);
  return out;
}

TEST(Chain, RangesAreThoseOfTheScene) {
  osi::ChainFile file = chain_of({"tracer"});
  file.set("tracer", "mover_material", "grey_target");
  osi::Chain chain(file);
  const osi::SensorData d = run(chain, drive(0));
  ASSERT_EQ(d.views[0]->lidar.size(), 1u);
  const auto& l = d.views[0]->lidar[0];
  ASSERT_EQ(l.reflections.size(), l.configuration->directions.size());
  // The lidar stands at x = 0 − 1.4 + 3.7 = 2.3, z = 0.75 − 0.45 + 0.3 = 0.6. The car's rear is at
  // 15 − 2.3 = 12.7.
  size_t on_car = 0, on_ground = 0;
  for (size_t i = 0; i < l.reflections.size(); ++i) {
    const osi::Reflection& f = l.reflections[i];
    if (f.is_miss()) continue;
    const double range = f.time_of_flight_s * 299792458 / 2;
    const Vec3 p = range * l.configuration->directions[i].cast<double>() + Vec3(2.3, 0, 0.6);
    if (f.object_id == 1) {
      ++on_car;
      EXPECT_NEAR(p.x(), 12.7, 1e-4);
      EXPECT_LE(std::abs(p.y() - 0.4), 0.9 + 1e-4);
      // A Lambertian target of ρ = 0.1 by the lidar equation; a white one at 1 m has 0 dB.
      const double cosine = double(l.configuration->directions[i].x());
      EXPECT_NEAR(f.signal_db, 10 * std::log10(0.1 * cosine / (range * range)), 1e-3);
    } else {
      ++on_ground;
      EXPECT_EQ(f.object_id, osi::kNoId);
      EXPECT_NEAR(p.z(), 0, 1e-4);
    }
  }
  EXPECT_GT(on_car, 20u);
  EXPECT_GT(on_ground, 20u);
}

TEST(Chain, FollowsTheCarAheadOfTheHost) {
  osi::Chain chain(whole());
  osi::SensorData d;
  for (int k = 0; k < 30; ++k) {
    d = run(chain, drive(k));
    EXPECT_EQ(d.objects.size(), k < 2 ? 0u : 1u) << k;
  }
  const osi::DetectedObject& o = d.objects[0];
  // In the vehicle's frame, whose origin is the rear axle.
  const double t = 29 * 0.08;
  EXPECT_NEAR(o.base.position_m->x(), 15 + 2 * t + 1.4, 0.35);
  EXPECT_NEAR(o.base.position_m->y(), 0.4, 0.15);
  EXPECT_NEAR(o.base.velocity_m_s->x(), 2, 0.3);
  EXPECT_NEAR(o.base.dimension_m->x(), 4.6, 0.4);
  EXPECT_EQ(o.ground_truth_ids, std::vector<uint64_t>{1});
  EXPECT_NEAR(o.age_s, t, 1e-6);
  EXPECT_EQ(o.measurement_state, 2u);
  EXPECT_EQ(o.movement_state, 3u);
  EXPECT_EQ(d.object_header->cycle_counter, 29u);
  EXPECT_EQ(d.sensor_id, 4u);
  ASSERT_EQ(d.free_area.size(), 1u);
  // The free area ends before the car ahead.
  const auto& ahead = d.free_area[0][0];
  EXPECT_LT(ahead.x(), 15 + 2 * t + 1.4 - 2.3 + 0.5);
}

TEST(Chain, IsTheSameForAnyNumberOfThreads) {
  std::vector<std::string> runs;
  for (const int n : {1, 2, 5}) {
    set_threads(n);
    osi::Chain chain(whole());
    std::string all;
    for (int k = 0; k < 10; ++k) all += bytes_of(run(chain, drive(k)));
    runs.push_back(all);
  }
  set_threads(0);
  EXPECT_EQ(runs[0], runs[1]);
  EXPECT_EQ(runs[0], runs[2]);
}

TEST(Chain, PartsInARowAreTheWhole) {
  osi::Chain all(whole()), first(chain_of({"tracer", "front_end"}));
  osi::Chain second(chain_of({"alignment", "tracking", "classification", "grid"}));
  for (int k = 0; k < 10; ++k) {
    const std::string between = bytes_of(run(first, drive(k)));
    osi::SensorData d = osi::read_sensor_data(between, "between");
    second.step(d);
    EXPECT_EQ(bytes_of(d), bytes_of(run(all, drive(k)))) << k;
  }
}

TEST(Chain, CopiesGoOnAndResetsBeginAnew) {
  osi::Chain chain(whole());
  std::string first;
  for (int k = 0; k < 5; ++k) first += bytes_of(run(chain, drive(k)));
  osi::Chain copy = chain.clone();
  for (int k = 5; k < 10; ++k) {
    EXPECT_EQ(bytes_of(run(chain, drive(k))), bytes_of(run(copy, drive(k))));
  }
  chain.reset();
  std::string again;
  for (int k = 0; k < 5; ++k) again += bytes_of(run(chain, drive(k)));
  EXPECT_EQ(again, first);
}

TEST(Chain, RealPipelineKnowsNoTruth) {
  osi::ChainFile file = whole();
  file.set("tracking", "pipeline", "real");
  osi::Chain chain(file);
  osi::SensorData d;
  for (int k = 0; k < 20; ++k) d = run(chain, drive(k));
  ASSERT_EQ(d.objects.size(), 1u);
  EXPECT_TRUE(d.objects[0].ground_truth_ids.empty());
  EXPECT_NEAR(d.objects[0].base.velocity_m_s->x(), 2, 0.5);
}

TEST(Chain, LatencyHoldsObjectsBack) {
  osi::ChainFile file = whole();
  file.set("tracking", "latency_ms", "100");
  osi::Chain chain(file);
  osi::SensorData d;
  for (int k = 0; k < 10; ++k) d = run(chain, drive(k));
  ASSERT_EQ(d.objects.size(), 1u);
  EXPECT_EQ(*d.object_header->measurement_time, osi::Timestamp::of(0.08 * 8));
  EXPECT_EQ(*d.timestamp, osi::Timestamp::of(0.8));
}

std::string reason_of(osi::Chain& chain, const osi::SensorView& view) {
  try {
    run(chain, view);
  } catch (const DataError& e) {
    return e.what();
  }
  return "";
}

TEST(Chain, SaysWhatIsMissing) {
  osi::Chain all(whole()), tracking(chain_of({"tracking"})), front(chain_of({"front_end"}));
  osi::SensorView view = drive(0);
  EXPECT_THAT(reason_of(tracking, view), HasSubstr("alignment"));
  EXPECT_THAT(reason_of(front, view), HasSubstr("no lidar_sensor_view"));
  view.lidar.emplace_back().reflections.resize(7);
  EXPECT_THAT(reason_of(front, view), HasSubstr("7 reflections for"));
  view = drive(0);
  view.timestamp.reset();
  EXPECT_THAT(reason_of(all, view), HasSubstr("no time"));
  view = drive(0);
  view.host_vehicle_id = 77;
  EXPECT_THAT(reason_of(all, view), HasSubstr("no host vehicle"));
}

TEST(Chain, TheGroundLiesBelowTheHostAndTheLidarAboveIt) {
  // Everything 30 m higher, as on a hill.
  osi::SensorView hill = drive(0);
  for (osi::MovingObject& m : hill.truth->moving) m.base.position_m->z() += 30;
  osi::Chain chain(chain_of({"tracer"}));
  const auto on_ground = [](const osi::SensorData& d) {
    size_t n = 0;
    for (const osi::Reflection& f : d.views[0]->lidar[0].reflections) {
      n += !f.is_miss() && f.object_id == osi::kNoId;
    }
    return n;
  };
  EXPECT_GT(on_ground(run(chain, hill)), 20u);
  EXPECT_EQ(on_ground(run(chain, hill)), on_ground(run(chain, drive(0))));
  osi::ChainFile low = chain_of({"tracer"});
  low.set("tracer", "z_m", "-1.2");
  osi::Chain below(low);
  EXPECT_THAT(reason_of(below, drive(0)), HasSubstr("the lidar is 0.90 m below the ground"));
  low.set("tracer", "ground", "false");
  osi::Chain in_the_air(low);
  EXPECT_EQ(reason_of(in_the_air, drive(0)), "");
}

TEST(Replay, TracesMessagesWithoutReflections) {
  io::TemporaryFolder folder;
  for (const bool has_reflections : {false, true}) {
    const std::filesystem::path file = folder / (has_reflections ? "sv_with.osi" : "sv_alone.osi");
    osi::Chain tracer(chain_of({"tracer"}));
    osi::TraceWriter writer(file);
    for (int k = 0; k < 8; ++k) {
      std::string bytes;
      osi::write(has_reflections ? *run(tracer, drive(k)).views[0] : drive(k), bytes);
      writer.write(bytes);
    }
    writer.close();
    osi::TraceReader reader(file);
    osi::Replay replay(reader, {});
    osi::SensorData data;
    size_t lists = 0, objects = 0;
    for (; replay.next(data); ++lists) {
      objects += data.objects.size();
      EXPECT_EQ(data.views[0]->lidar.size(), 1u);
      // The numbers of the truth are no detected objects.
      for (const auto& l : data.lidar) {
        for (const osi::LidarDetection& d : l.detections) EXPECT_EQ(d.object_id, osi::kNoId);
      }
    }
    EXPECT_EQ(lists, 8u);
    EXPECT_GT(objects, 3u) << has_reflections;
  }
}

std::string reason_of(const std::string& yaml) {
  io::TemporaryFolder folder;
  io::put_bytes(folder / "chain.yaml", yaml);
  io::put_bytes(folder / "blind.yaml", "blind");
  try {
    osi::Chain(osi::read_chain((folder / "chain.yaml").string()));
  } catch (const FormatError& e) {
    EXPECT_EQ(e.file(), (folder / "chain.yaml").string());
    return e.place() + ": " + e.reason();
  }
  return "";
}

TEST(Chain, FilesAreChecked) {
  EXPECT_EQ(reason_of("chain:\n  - strategy: alignment\n    deskew: true\n"), "");
  EXPECT_THAT(reason_of("strategies: []\n"), HasSubstr("a list of strategies"));
  EXPECT_THAT(reason_of("chain:\n  - deskew: true\n"), HasSubstr("chain[0]: names no strategy"));
  EXPECT_THAT(reason_of("chain:\n  - strategy: dance\n"), HasSubstr("unknown strategy"));
  EXPECT_THAT(reason_of("chain:\n  - strategy: grid\n    cell: 1\n"),
              HasSubstr("chain[0].cell: unknown parameter of grid"));
  EXPECT_THAT(reason_of("chain:\n  - strategy: grid\n    cell_m: wide\n"),
              HasSubstr("chain[0].cell_m: must be a number from 0.01 to 10"));
  EXPECT_THAT(reason_of("chain:\n  - strategy: tracking\n    pipeline: magic\n"),
              HasSubstr("must be one of model, real"));
  EXPECT_THAT(reason_of("chain:\n  - strategy: mine\n    library: none.so\n"),
              HasSubstr("chain[0].library"));
  EXPECT_THAT(reason_of("chain: [\n"), HasSubstr("line"));
  for (const std::string name : {"tracer", "front_end"}) {
    EXPECT_THAT(reason_of("chain:\n  - strategy: " + name + "\n    sensor: blind.yaml\n"),
                HasSubstr("blind.yaml: expected lines of KEY: VALUE"));
  }
}

TEST(StaticData, AreRememberedInTheBytesToo) {
  osi::StaticData known;
  osi::SensorView first = drive(0), second = drive(1);
  known.fill(first);
  second.version.reset();
  second.host_vehicle_id.reset();
  second.truth->moving[0].centre_to_rear_m.reset();
  second.bytes.clear();
  std::string bytes;
  osi::write(second, bytes);
  osi::SensorView view = osi::read_sensor_view(bytes, "second");
  EXPECT_FALSE(view.host());
  known.fill(view);
  ASSERT_TRUE(view.host());
  EXPECT_EQ(view.host()->centre_to_rear_m, Vec3(-1.4, 0, -0.45));
  EXPECT_EQ(osi::read_sensor_view(view.bytes, "filled").host_vehicle_id, 0u);
}

TEST(Objects, EqualNumbersAreRefused) {
  osi::GroundTruth t;
  t.moving = {car(0, 0, 0, 0), car(5, 9, 0, 0), car(5, 19, 0, 0)};
  perception::TruthFrame frame;
  EXPECT_THROW(osi::truth_of(t, 0, "trace", frame), FormatError);
  t.moving[2].id = 6;
  osi::truth_of(t, 0, "trace", frame);
  ASSERT_EQ(frame.objects.size(), 2u);
  EXPECT_EQ(frame.objects[0].id, 6u);
  EXPECT_EQ(frame.objects[0].label, perception::ObjectClass::kCar);
}

TEST(RealTraces, RunThroughTheChain) {
  UNDERBRUSH_NEEDS_DATA("osi");
  osi::TraceReader reader(test::data_folder() /
                          "osi/20240618T122540Z_sv_370_244_20_minimal_valid_example.osi");
  osi::Chain chain(whole());
  osi::StaticData known;
  size_t objects = 0;
  for (std::string m; reader.next(m);) {
    auto view = std::make_shared<osi::SensorView>(osi::read_sensor_view(m, reader.place()));
    known.fill(*view);
    const osi::SensorData d = chain.step(view);
    for (const osi::DetectedObject& o : d.objects) {
      EXPECT_EQ(o.ground_truth_ids, std::vector<uint64_t>{250});
      ++objects;
    }
  }
  EXPECT_EQ(objects, 18u);
}

}  // namespace
}  // namespace underbrush
