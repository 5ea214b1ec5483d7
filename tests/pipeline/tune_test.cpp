#include "underbrush/pipeline/tune.hpp"

#include <gtest/gtest.h>

#include "io/temporary.hpp"
#include "optimize/logs.hpp"
#include "primitives/sites.hpp"
#include "underbrush/fit/fit.hpp"
#include "underbrush/optimize/densities.hpp"
#include "underbrush/pipeline/score_logs.hpp"
#include "underbrush/pipeline/simulate_log.hpp"

namespace underbrush::pipeline {
namespace {

using optimize::Outcome;

TEST(Objective, OfAWorldIsThatOfItsAnswersScored) {
  const BeamLog log = test::drive_past_bushes(1, 4);
  MemorySource source(log);
  const fit::FitResult fitted = fit::fit(source, {});
  const TracedWorld world(fitted.model);
  const Outcome a = outcome_of("packet_f1", world, log, 7), b = outcome_of("nll", world, log, 7);
  SimulateOptions options;
  options.seed = 7;
  Simulation simulation(world, options);
  const BeamLog answered = simulate_log(simulation, log);
  MemorySource simulated(answered);
  const metrics::Summary s = score_log(source, simulated, &world, {.cloud = false}).all;
  EXPECT_EQ(a.objective, s.packet_error_m + 2 * (1 - s.f1));
  EXPECT_EQ(a.score.at("f1"), s.f1);
  EXPECT_EQ(a.score.count("crps_m"), 0u);
  EXPECT_EQ(b.objective, s.nll_per_beam);
  EXPECT_EQ(b.score.at("crps_m"), s.crps_m);
}

TEST(Objective, DoesNotChangeIfRangeOffsetsAreInTheLogAndInTheModel) {
  BeamLog log = test::drive_past_bushes(5, 4);
  log.info.sensor = "two channels";
  for (size_t i = 0; i < log.size(); ++i) log.ring[i] = uint16_t(i % 2);
  MemorySource source(log);
  elements::Model model = fit::fit(source, {}).model;
  model.channels.clear();
  elements::Model with_offsets = model;
  with_offsets.channels = {{0, 0.4, 0.01}, {1, -0.4, 0.01}};
  BeamLog measured = log;
  add_offsets(with_offsets.channels, 1, measured);
  for (const std::string& objective : optimize::objectives()) {
    const double without = outcome_of(objective, TracedWorld(model), log, 7).objective;
    const double both = outcome_of(objective, TracedWorld(with_offsets), measured, 7).objective;
    const double log_only = outcome_of(objective, TracedWorld(model), measured, 7).objective;
    EXPECT_NEAR(both, without, 0.002) << objective;
    EXPECT_GT(log_only, without + 0.1) << objective;
  }
}

TEST(Objective, OfABadStartIsMuchBetterAfterASearch) {
  const BeamLog log = test::drive_past_bushes(2, 8);
  MemorySource source(log);
  fit::FitOptions bad;
  bad.volumetric.hierarchical.clusters_per_point = 0.005;  // a few ellipsoids for all bushes
  bad.tau = 1;
  bad.keyframes.spacing_m = 0;  // which would answer in place of the ellipsoids
  optimize::TuneOptions options;
  options.tune = {"clusters-per-point", "tau"};
  options.search = {"cobyla", 15, 0.25};
  for (const std::string& objective : optimize::objectives()) {
    options.objective = objective;
    const std::vector<optimize::Evaluation> tried = tune(tuned_fit(source, options, bad), options);
    const double from = tried.front().outcome.objective,
                 to = tried[optimize::best_of(tried)].outcome.objective;
    EXPECT_LT(to, from - 0.3) << objective << " " << from << " " << to;
  }
}

TEST(Densities, AreThoseOfTheAnnotationsClassesAndReachTheScene) {
  const io::TemporaryFolder folder;
  std::vector<primitives::Primitive> set(1);
  set[0].label = elements::Class::kSmallTree;
  set[0].box = {Vec3(-1, -1, 0), Vec3(1, 1, 4)};
  set[0].model.ellipsoids.emplace_back();
  set[0].model.ellipsoids[0].mean = Vec3f(0, 0, 1.5f);
  set[0].model.max_range_m = 50;
  primitives::write_primitives(folder / "set", set, 2, "");
  primitives::Annotation site;
  for (int k = 0; k < 16; ++k) {
    primitives::PlacedObject o;
    o.label = elements::Class::kSmallTree;
    o.position = Vec3(6 * (k % 4) - 9, 6 * (k / 4) - 9, 0);
    o.box = set[0].box;
    site.objects.push_back(o);
  }
  const std::vector<optimize::Parameter> densities = optimize::density_parameters(site);
  ASSERT_EQ(densities.size(), 1u);
  EXPECT_EQ(densities[0].name, "small_tree");
  elements::Model ground = test::plane(40, 0, 0);
  ground.origin = Vec3::Zero();
  const primitives::PrimitiveSet read = primitives::read_primitive_set(folder / "set");
  const SceneParts parts{site, ground, read, {}, {}};
  const BeamLog other = test::drive_past_bushes(3, 2);
  MemorySource beams(other);
  const TuningProblem elsewhere = tuned_scene(beams, {}, parts);
  const auto answered = [&](double density) {
    return elsewhere.objective(std::vector<double>{density});
  };
  // The beams come from another world; the test only asks that fewer trees give other answers.
  EXPECT_NE(answered(1).objective, answered(0.1).objective);
  EXPECT_EQ(answered(1).objective,
            tuned_scene(beams, {}, parts).objective(std::vector<double>{1}).objective);
  // The density that made the composed scene answers the log of that scene best.
  const primitives::Composition truth = primitives::compose(site, ground, read, {});
  SimulateOptions options;
  options.seed = 99;
  const TracedWorld world(truth.scene, truth.info);
  Simulation simulation(world, options);
  const BeamLog log = simulate_log(simulation, test::drive_past_bushes(4, 4));
  MemorySource own(log);
  const TuningProblem problem = tuned_scene(own, {}, parts);
  const auto objective = [&](double density) {
    return problem.objective(std::vector<double>{density}).objective;
  };
  EXPECT_LT(objective(1), objective(0.3));
  EXPECT_LT(objective(1), objective(2.5));
}

}  // namespace
}  // namespace underbrush::pipeline
