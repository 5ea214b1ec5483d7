// Tests of keyframes in the answers to logs that do not name their sensor.
#include <gtest/gtest.h>

#include "ball_scanner.hpp"
#include "io/temporary.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/pipeline/score_logs.hpp"
#include "underbrush/pipeline/simulate_log.hpp"

namespace underbrush::pipeline {
namespace {

BeamLog unnamed(const std::vector<double>& at, uint32_t first_scan) {
  BeamLog log = test::scanned(at, first_scan, 0.7);
  log.info.sensor.clear();
  return log;
}

/// The same beams from a sensor that numbers its channels from below.
BeamLog of_another_sensor(BeamLog log) {
  for (uint16_t& ring : log.ring) ring = uint16_t(test::kRings - 1 - ring);
  return log;
}

struct Answers {
  std::vector<float> range_m;
  bool by_keyframes;
};

Answers answers(const TracedWorld& world, const BeamLog& log, size_t chunk,
                const SimulateOptions& options = {}) {
  Simulation simulation(world, options);
  MemorySource source(log, chunk);
  BeamLog out = simulate_log(simulation, source);
  return {std::move(out.range_m), simulation.keyframes_serve(log.info)};
}

TEST(Matter, SwaysAsItsModelUnlessAskedOtherwise) {
  elements::Model model = test::fitted(unnamed(test::kDrive, 0), 1);
  EXPECT_EQ(TracedWorld(model).sway_s(), 0);
  model.sway_s = 0.5;
  EXPECT_EQ(TracedWorld(model).sway_s(), 0.5);
  SimulateOptions options;
  options.sway_s = 2;
  EXPECT_EQ(TracedWorld(model, matter_of(options)).sway_s(), 2);
  options.matter = "still";
  EXPECT_THROW(TracedWorld(model, matter_of(options)), std::invalid_argument);
  options.sway_s = 0;
  EXPECT_EQ(TracedWorld(model, matter_of(options)).sway_s(), 0);
}

TEST(Recognise, KeyframesAnswerTheSameSensorAndNoOther) {
  const elements::Model model = test::fitted(unnamed(test::kDrive, 0), 1);
  const TracedWorld world(model);
  const BeamLog same = unnamed({1.3, 3}, 100), other = of_another_sensor(same);
  SimulateOptions elements_alone;
  elements_alone.keyframes = false;
  for (const size_t chunk : {size_t(1) << 20, size_t(777)}) {
    const Answers own = answers(world, same, chunk), foreign = answers(world, other, chunk);
    EXPECT_TRUE(own.by_keyframes);
    EXPECT_FALSE(foreign.by_keyframes);
    EXPECT_NE(own.range_m, answers(world, same, chunk, elements_alone).range_m);
    EXPECT_EQ(foreign.range_m, answers(world, other, chunk, elements_alone).range_m);
  }
  Simulation simulation(world, {});
  EXPECT_EQ(simulate_log(simulation, same).range_m, answers(world, same, 777).range_m);
  EXPECT_EQ(simulate_log(simulation, other).range_m, answers(world, other, 777).range_m);
  EXPECT_EQ(simulate_log(simulation, same).range_m, answers(world, same, 777).range_m);
}

TEST(Recognise, TheBeamsOfAFileAreThoseOfALogInMemory) {
  const elements::Model model = test::fitted(unnamed(test::kDrive, 0), 1);
  const TracedWorld world(model);
  const io::TemporaryFolder folder;
  const std::filesystem::path file = folder / "log.ply";
  const BeamLog written = unnamed({1.3, 3}, 100);
  io::LogWriter writer(file, written.info, "");
  writer.write(written);
  writer.close();
  for (const std::string beams : {"", "100:3000"}) {
    SimulateOptions options;
    options.beams = beams;
    const Answers expected = answers(world, io::read_log(file), 777, options);
    Simulation simulation(world, options);
    io::BeamReader reader(file, 777);
    const BeamLog log = simulate_log(simulation, reader);
    EXPECT_EQ(log.range_m, expected.range_m);
    EXPECT_EQ(log.size(), beams.empty() ? written.size() : 2900);
    EXPECT_TRUE(simulation.keyframes_serve(log.info));
  }
}

TEST(Recognise, AScoreOfAnotherSensorIsThatOfTheElements) {
  elements::Model with = test::fitted(unnamed(test::kDrive, 0), 1), without = with;
  without.keyframes.reset();
  const auto nll = [](const elements::Model& model, const BeamLog& log) {
    const TracedWorld world(model);
    MemorySource real(log), simulated(log);
    return score_log(real, simulated, &world, {.cloud = false}).all.nll_per_beam;
  };
  const BeamLog same = unnamed({1.3, 3}, 100), other = of_another_sensor(same);
  EXPECT_NE(nll(with, same), nll(without, same));
  EXPECT_EQ(nll(with, other), nll(without, other));
}

}  // namespace
}  // namespace underbrush::pipeline
