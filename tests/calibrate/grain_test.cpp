#include "underbrush/calibrate/grain.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/radiometry/materials.hpp"
#include "underbrush/sensor/sensor.hpp"
#include "underbrush/simulate/echoes.hpp"
#include "underbrush/simulate/simulate.hpp"

namespace underbrush::calibrate {
namespace {

/// Makes a hedge of ellipsoids 10 m away, 2 m high, with a rough wall above it.
elements::Model hedge_and_wall() {
  elements::Model model;
  model.tau = 3;
  for (double y = -5; y <= 5; y += 0.3) {
    for (double z = -2; z <= 0; z += 0.3) {
      elements::Ellipsoid e;
      e.mean = Vec3(10.03, y, z).cast<float>();
      e.set_covariance(0.0225 * Mat3::Identity());
      e.hit.p = 0.6f;
      model.ellipsoids.push_back(e);
    }
  }
  auto& mesh = model.surface;
  mesh.vertices = {{10.03f, -6, 0.5f}, {10.03f, 6, 0.5f}, {10.03f, 6, 4}, {10.03f, -6, 4}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.hit.resize(2);
  mesh.range_sigma_m = 0.1;
  return model;
}

/// Makes 40 rings of 1000 beams towards it, 5 mm apart there, in firing order.
BeamLog beams_to_it() {
  BeamLog log;
  log.info.max_range_m = 60;
  constexpr size_t kRows = 40, kColumns = 1000;
  log.resize(kRows * kColumns);
  for (size_t i = 0; i < log.size(); ++i) {
    const double y = 0.005 * (double(i / kRows) - kColumns / 2.0);
    const double z = -1.8 + 0.1 * double(i % kRows);
    log.direction[i] = Vec3(10, y, z).normalized().cast<float>();
    log.ring[i] = uint16_t(i % kRows);
  }
  return log;
}

TEST(LearnGrain, FindsTheGrainAndTheNoiseOfTheWorldThatTheLogIsOf) {
  for (const auto& [ellipsoid_m, mesh_m] : {std::pair{0.02, 0.1}, {0.06, 0.03}}) {
    elements::Model model = hedge_and_wall();
    model.grain = {ellipsoid_m, mesh_m, {}};
    model.range_noise_m = 0.01;
    BeamLog log = beams_to_it();
    const trace::World world(model, trace::Isa::kBest, trace::Draws::kOnce);
    simulate::Options options;
    options.seed = 42;
    simulate::simulate(world, options, 0, log);
    MemorySource source(log);
    elements::Model learnt = hedge_and_wall();
    learnt.range_noise_m = 0.02;
    learnt.light.max_intensity = 200;
    const GrainReport report = learn_grain(learnt, source, 1);
    EXPECT_EQ(learnt.light.max_intensity, 200);
    EXPECT_TRUE(report.ellipsoids);
    EXPECT_TRUE(report.meshes);
    EXPECT_NEAR(std::log(learnt.grain.ellipsoid_m / ellipsoid_m), 0, std::log(1.5));
    EXPECT_NEAR(std::log(learnt.grain.mesh_m / mesh_m), 0, std::log(1.5));
    EXPECT_NEAR(report.simulated_m, report.real_m, 0.15 * report.real_m);
    EXPECT_GT(report.anew_m, 1.5 * report.real_m);
    EXPECT_LE(learnt.range_noise_m, 0.02);
  }
}

TEST(LearnGrain, FindsTheGrainOfEachClass) {
  constexpr uint32_t kFine = 2, kCoarse = 6, kRare = 9;
  elements::Model model = hedge_and_wall();
  for (elements::Ellipsoid& e : model.ellipsoids) e.label = e.mean.y() < 0 ? kFine : kCoarse;
  model.ellipsoids.back().label = kRare;
  model.grain = {0.05, 0.1, {{kFine, 0.025}, {kCoarse, 0.09}, {kRare, 0.02}}};
  model.range_noise_m = 0.01;
  BeamLog log = beams_to_it();
  const trace::World world(model, trace::Isa::kBest, trace::Draws::kOnce);
  simulate::simulate(world, {}, 0, log);
  MemorySource source(log);
  elements::Model learnt = model;
  learnt.grain = {0.05, 0.05, {{kFine, 0.04}, {kCoarse, 0.04}, {kRare, 0.04}}};
  const GrainReport report = learn_grain(learnt, source, 1);
  EXPECT_EQ(report.classes, (std::vector<bool>{true, true, false}));
  EXPECT_FALSE(report.ellipsoids);  // All ellipsoids are of these classes.
  EXPECT_NEAR(std::log(learnt.grain.classes[0].side_m / 0.025), 0, std::log(1.5));
  EXPECT_NEAR(std::log(learnt.grain.classes[1].side_m / 0.09), 0, std::log(1.5));
  EXPECT_EQ(learnt.grain.classes[2].side_m, 0.04);
}

TEST(LearnGrainOfEchoes, FindsTheGrainThatMadeThem) {
  for (const double grain_m : {0.005, 0.01, 0.02}) {
    elements::Model model = hedge_and_wall();
    model.sensor = "riegl-vz400i";
    model.grain.ellipsoid_m = grain_m;
    BeamLog log = beams_to_it();
    const sensor::Sensor sensor = sensor::load(model.sensor);
    simulate::Instrument instrument;
    instrument.beam = sensor.beam;
    instrument.sub_rays = sensor::spread_sub_rays(sensor.beam, 25);
    instrument.receiver = radiometry::receiver_options(sensor);
    const simulate::Reflection reflection(radiometry::load_materials(""), sensor.wavelength_m);
    // A second hedge behind the first one, for second echoes.
    for (size_t k = 0, n = model.ellipsoids.size(); k < n; ++k) {
      model.ellipsoids.push_back(model.ellipsoids[k]);
      model.ellipsoids.back().mean.x() += 3;
    }
    elements::Model learnt = model;
    learnt.grain = {0.05, 0.05, {{2, 0.1}}};
    const trace::World world(model, trace::Isa::kBest, trace::Draws::kOnce);
    const simulate::DynamicWorld still(world);
    simulate::EchoOptions echoes;
    echoes.seed = 42;
    simulate::EchoMaker(still, reflection, instrument, echoes).answer(0, log);
    MemorySource source(log);
    const EchoGrainReport report = learn_grain_of_echoes(learnt, source, 1);
    EXPECT_TRUE(report.learnt);
    EXPECT_NEAR(report.simulated, report.real, 0.25 * (report.real - 1));
    EXPECT_NEAR(std::log(learnt.grain.ellipsoid_m / grain_m), 0, std::log(1.3));
    EXPECT_NEAR(learnt.grain.classes[0].side_m, 2 * learnt.grain.ellipsoid_m, 1e-9);
    EXPECT_EQ(learnt.grain.mesh_m, model.grain.mesh_m);
  }
}

TEST(LearnGrainOfEchoes, LearnsNothingFromOneEchoABeamOrAnUnknownSensor) {
  elements::Model model = hedge_and_wall();
  model.sensor = "riegl-vz400i";
  const BeamLog beams = beams_to_it();
  MemorySource source(beams);
  EXPECT_FALSE(learn_grain_of_echoes(model, source, 1).learnt);
  model.sensor.clear();
  EXPECT_FALSE(learn_grain_of_echoes(model, source, 1).learnt);
  EXPECT_EQ(model.grain.ellipsoid_m, hedge_and_wall().grain.ellipsoid_m);
}

TEST(LearnGrain, KeepsWhatTheModelHadWhereTheLogTellsNothing) {
  elements::Model model = hedge_and_wall();
  const elements::Grain before = model.grain;
  BeamLog log = beams_to_it();
  for (size_t i = 0; i < log.size(); ++i) log.ring[i] = uint16_t(i);  // no two beams of a ring
  MemorySource source(log);
  const GrainReport report = learn_grain(model, source, 1);
  EXPECT_FALSE(report.ellipsoids || report.meshes);
  EXPECT_EQ(model.grain.ellipsoid_m, before.ellipsoid_m);
  EXPECT_EQ(model.grain.mesh_m, before.mesh_m);
  const BeamLog empty;
  MemorySource nothing(empty);
  learn_grain(model, nothing, 1);
}

}  // namespace
}  // namespace underbrush::calibrate
