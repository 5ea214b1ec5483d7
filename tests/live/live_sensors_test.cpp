#include "underbrush/live/live_sensors.hpp"

#include <gtest/gtest.h>

#include <map>

#include "live/site.hpp"

namespace underbrush::live {
namespace {

using namespace test;

perception::Rig two_sensors() {
  return {"two",
          {{"top", "velodyne-vlp16", turned(0.1, {0, 0, 0.3}), 0, 0},
           {"front", "ibeo-lux-2010", turned(-0.4, {2, 0.1, -0.9}), 0, 0}}};
}

/// All columns of the same bits.
void expect_equal(const BeamLog& a, const BeamLog& b) {
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GT(a.size(), 0u);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_EQ(a.range_m, b.range_m);
  EXPECT_EQ(a.intensity, b.intensity);
  EXPECT_EQ(a.time_s, b.time_s);
  EXPECT_EQ(a.ring, b.ring);
  EXPECT_EQ(a.scan, b.scan);
  EXPECT_EQ(a.packet, b.packet);
  EXPECT_EQ(a.extra, b.extra);
}

/// The beams of all parts, one after the other.
BeamLog parts(LiveSensors& sensors) {
  BeamLog out;
  for (size_t k = 1; k < boundaries().size(); ++k) append(out, sensors.fire(part(k)));
  return out;
}

/// The same world, in which the cart has its whole trajectory from the beginning.
pipeline::TracedWorld whole_world(const pipeline::Matter& matter) {
  return pipeline::TracedWorld(site(Trajectory(poses(boundaries(), cart_at))), matter);
}

TEST(LiveSensors, PartsAreTheBeamsThatSimulateAnswers) {
  const Trajectory path(poses(boundaries(), vehicle_at));
  for (const char* name : {"velodyne-vlp16", "velodyne-hdl32e", "ibeo-lux-2010", "generic-raster",
                           "livox-avia", "ouster-os1-64"}) {
    for (const bool is_instrument : {false, true}) {
      pipeline::SimulateOptions options;
      options.seed = 5;
      options.element_ids = true;
      options.sway_s = is_instrument ? 0 : 0.02;
      if (is_instrument) options.instrument.super_sample = "3";
      if (is_instrument && std::string_view(name) != "velodyne-vlp16") continue;
      const pipeline::TracedWorld whole = whole_world(matter_of(options));
      pipeline::Simulation simulation(whole, options,
                                      [&](const char*) { return sensor::load(name); });
      pipeline::SensorBeams beams(sensor::load(name), path);
      const BeamLog expected = simulate_log(simulation, beams);
      pipeline::TracedWorld world(site(), matter_of(options));
      LiveSensors live(world, options, sensor::load(name));
      SCOPED_TRACE(name);
      expect_equal(parts(live), expected);
    }
  }
}

/// A world whose matter sways with a correlation time that its models have learnt.
pipeline::World swaying(pipeline::World world, double sway_s) {
  for (elements::Model& m : world.scene.models) m.sway_s = sway_s;
  return world;
}

TEST(LiveSensors, LeavesSwayInTheTimeOfTheWorldAsInSimulate) {
  constexpr double kSway = 0.06;
  const Trajectory path(poses(boundaries(), vehicle_at)), cart(poses(boundaries(), cart_at));
  for (const char* super_sample : {"", "3"}) {
    SCOPED_TRACE(super_sample);
    pipeline::SimulateOptions options;
    options.instrument.super_sample = super_sample;
    const sensor::Sensor vlp16 = sensor::load("velodyne-vlp16");
    const pipeline::TracedWorld whole(swaying(site(cart), kSway));
    ASSERT_EQ(whole.sway_s(), kSway);
    pipeline::Simulation simulation(whole, options,
                                    [&](const char*) { return sensor::Sensor(vlp16); });
    pipeline::SensorBeams beams(vlp16, path);
    pipeline::TracedWorld world(swaying(site(), kSway)), still_world(site());
    LiveSensors live(world, options, vlp16), still(still_world, options, vlp16);
    const BeamLog answered = parts(live);
    expect_equal(answered, simulate_log(simulation, beams));
    EXPECT_NE(answered.range_m, parts(still).range_m);
  }
  pipeline::SimulateOptions options;
  const pipeline::TracedWorld whole(swaying(site(cart), kSway));
  const auto beams = pipeline::rig_beams(two_sensors(), path);
  pipeline::Simulation simulation(whole, options, beams->sensors());
  pipeline::TracedWorld world(swaying(site(), kSway));
  LiveSensors live(world, options, two_sensors());
  expect_equal(parts(live), simulate_log(simulation, *beams));
}

TEST(LiveSensors, ALeafIsTheSameOneFromFiringToFiringForItsCorrelationTime) {
  constexpr double kSway = 0.4, kPeriod = 0.1;  // s
  pipeline::TracedWorld world(swaying(site(), kSway));
  LiveSensors live(world, {}, sensor::load("generic-raster"));
  const auto scan = [&](double time_s) {
    Firing f{time_s, time_s, time_s + kPeriod, {{{time_s, vehicle_at(0)}}}, {}};
    f.actors.push_back({"cart", {}, true});
    return live.fire(f);
  };
  // The share of beams that end elsewhere grows evenly with the time, up to the correlation time.
  std::map<int, double> changed;
  for (int first = 0; first < 20; ++first) {
    const BeamLog a = scan(7 + kPeriod * first);
    for (const int later : {1, 2, 4, 8}) {
      const BeamLog b = scan(7 + kPeriod * (first + later));
      ASSERT_EQ(a.direction, b.direction);
      for (size_t i = 0; i < a.size(); ++i) changed[later] += a.range_m[i] != b.range_m[i];
    }
  }
  ASSERT_GT(changed[8], 5000);
  EXPECT_NEAR(changed[1] / changed[8], 0.25, 0.05);
  EXPECT_NEAR(changed[2] / changed[8], 0.5, 0.05);
  EXPECT_NEAR(changed[4] / changed[8], 1, 0.05);
}

TEST(LiveSensors, PartsOfARigAreTheBeamsThatSimulateAnswers) {
  const Trajectory path(poses(boundaries(), vehicle_at));
  pipeline::SimulateOptions options;
  options.range_noise_m = 0.02;  // drawn by the number of the beam
  const pipeline::TracedWorld whole = whole_world({});
  const auto beams = pipeline::rig_beams(two_sensors(), path);
  pipeline::Simulation simulation(whole, options, beams->sensors());
  const BeamLog expected = simulate_log(simulation, *beams);
  pipeline::TracedWorld world(site());
  LiveSensors live(world, options, two_sensors());
  expect_equal(parts(live), expected);
  const BeamLog again = live.fire(part(3));
  live.fire(part(6));
  expect_equal(live.fire(part(3)), again);
}

TEST(LiveSensors, AFiringDependsOnItsRequestAlone) {
  pipeline::TracedWorld world(site());
  LiveSensors live(world, {}, sensor::load("velodyne-vlp16"));
  const BeamLog first = live.fire(part(3));
  live.fire(part(6));
  Firing without = part(3);
  without.actors[0].is_absent = true;
  Firing far = part(3);
  far.actors[0].motion = {{{7, turned(0, {5000, 0, 0})}}};
  EXPECT_EQ(live.fire(without).range_m, live.fire(far).range_m);
  EXPECT_NE(live.fire(far).range_m, first.range_m);
  expect_equal(live.fire(part(3)), first);
  without.actors.clear();
  EXPECT_NE(live.fire(without).range_m, first.range_m) << "the cart is back in its own place";
}

TEST(LiveSensors, AVelocityIsThePoseToWhichItLeads) {
  const Vec3 turn(0.2, -0.1, 0.9), velocity(3, -1, 0.1);
  const double duration_s = 0.1;
  const Pose from = vehicle_at(0);
  const Trajectory path = trajectory_of({{{7, from}}, velocity, turn}, 7 + duration_s);
  for (const double s : {0.0, 0.3, 1.0}) {
    const double t = s * duration_s;
    const Pose at = *path.at(7 + t);
    const Eigen::AngleAxisd rotation(t * turn.norm(), turn.normalized());
    EXPECT_LT((at.translation - from.translation - t * velocity).norm(), 1e-12);
    EXPECT_LT(at.rotation.angularDistance(rotation * from.rotation), 1e-7);
  }
  EXPECT_THROW(trajectory_of({{{7, from}}, velocity, 40 * turn}, 7.1), std::invalid_argument);
  EXPECT_THROW(trajectory_of({{{7, from}, {8, from}}, velocity, turn}, 7.1), std::invalid_argument);
}

TEST(LiveSensors, RefusesWhatCannotBe) {
  pipeline::TracedWorld world(site());
  LiveSensors live(world, {}, sensor::load("velodyne-vlp16"));
  const BeamLog before = live.fire(part(2));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](auto change) {
    Firing f = part(2);
    change(f);
    EXPECT_THROW(live.fire(f), std::invalid_argument);
  };
  refused([&](Firing& f) { f.until_s = nan; });
  refused([](Firing& f) { f.until_s = f.from_s - 1e-3; });
  refused([](Firing& f) { f.start_s = f.from_s + 1e-3; });
  refused([](Firing& f) { f.until_s += 1e-3; });
  refused([](Firing& f) { f.start_s = -1e300; });
  refused([](Firing& f) { f.vehicle.poses.clear(); });
  refused([](Firing& f) { f.vehicle.poses.push_back(f.vehicle.poses.back()); });
  for (int c = 0; c < 3; ++c) {
    refused([&](Firing& f) { f.vehicle.poses[0].world_from_sensor.translation[c] = nan; });
  }
  refused([](Firing& f) { f.vehicle.poses[0].world_from_sensor.translation.x() = 1e300; });
  refused([](Firing& f) { f.vehicle.poses[1].world_from_sensor.rotation.w() = 7; });
  refused([&](Firing& f) { f.vehicle.poses[1].world_from_sensor.rotation.w() = nan; });
  refused([](Firing& f) { f.actors[0].name = "van"; });
  refused([](Firing& f) { f.actors[0].motion.poses.clear(); });
  expect_equal(live.fire(part(2)), before);
}

}  // namespace
}  // namespace underbrush::live
