#include "underbrush/optimize/objective.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "io/temporary.hpp"
#include "optimize/logs.hpp"
#include "primitives/sites.hpp"
#include "underbrush/optimize/densities.hpp"
#include "underbrush/optimize/fit_parameters.hpp"

namespace underbrush::optimize {
namespace {

TEST(Objective, IsPacketErrorAndTwiceWhatF1Lacks) {
  metrics::Summary s;
  s.packet_error_m = 2.9;
  s.f1 = 0.68;
  EXPECT_DOUBLE_EQ(objective_of("packet_f1", s, 80), 2.9 + 2 * 0.32);
  s.nll_per_beam = 1.25;
  EXPECT_EQ(objective_of("nll", s, 80), 1.25);
}

TEST(Objective, IsFiniteAndWorstWhereNothingIsReturnedByBoth) {
  const metrics::Summary s;  // all scores are unknown
  EXPECT_EQ(objective_of("packet_f1", s, 80), 82);
  EXPECT_THROW(objective_of("nll", s, 80), std::invalid_argument);
  EXPECT_THROW(objective_of("chamfer", s, 80), std::invalid_argument);
}

TEST(Objective, OfAWorldIsThatOfItsAnswersScored) {
  const BeamLog log = test::drive_past_bushes(1, 4);
  MemorySource source(log);
  const fit::FitResult fitted = fit::fit(source, {});
  const trace::World world(fitted.model);
  const Outcome a = outcome_of("packet_f1", world, log, 7), b = outcome_of("nll", world, log, 7);
  BeamLog answered = log;
  simulate::Options options;
  options.seed = 7;
  simulate::simulate(world, options, 0, answered);
  MemorySource simulated(answered);
  metrics::ScoreOptions score;
  score.world = &world;
  const metrics::Summary s = metrics::score(source, simulated, score).all;
  EXPECT_EQ(a.objective, s.packet_error_m + 2 * (1 - s.f1));
  EXPECT_EQ(a.score.at("f1"), s.f1);
  EXPECT_EQ(a.score.count("crps_m"), 0u);
  EXPECT_EQ(b.objective, s.nll_per_beam);
  EXPECT_EQ(b.score.at("crps_m"), s.crps_m);
}

TEST(Objective, OfABadStartIsMuchBetterAfterASearch) {
  const BeamLog log = test::drive_past_bushes(2, 8);
  MemorySource source(log);
  const Slice slice = take_slice(source, {0, 10, 4, 1});
  fit::FitOptions bad;
  bad.volumetric.hierarchical.clusters_per_point = 0.005;  // a few ellipsoids for all bushes
  bad.tau = 1;
  bad.keyframes.spacing_m = 0;  // which would answer in place of the ellipsoids
  const std::string names[] = {"clusters-per-point", "tau"};
  const std::vector<FitParameter> tuned = chosen_fit_parameters(bad, names);
  std::vector<double> start;
  start.reserve(tuned.size());
  for (const FitParameter& p : tuned) start.push_back(p.of->number(bad));
  for (const std::string& objective : objectives()) {
    const std::vector<Evaluation> tried =
        search(std::vector<Parameter>(tuned.begin(), tuned.end()), start, {"cobyla", 15, 0.25},
               [&](std::span<const double> value) {
                 fit::FitOptions options = bad;
                 for (size_t k = 0; k < value.size(); ++k)
                   tuned[k].of->set_number(options, value[k]);
                 return fit_outcome(objective, slice, options);
               });
    const double from = tried.front().outcome.objective,
                 to = tried[best_of(tried)].outcome.objective;
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
  const std::vector<Parameter> densities = density_parameters(site);
  ASSERT_EQ(densities.size(), 1u);
  EXPECT_EQ(densities[0].name, "small_tree");
  elements::Model ground = test::plane(40, 0, 0);
  ground.origin = Vec3::Zero();
  const primitives::PrimitiveSet read = primitives::read_primitive_set(folder / "set");
  const SceneParts parts{site, ground, read};
  const auto answered = [&](double density) {
    return scene_outcome("packet_f1", parts, {}, densities, std::vector<double>{density},
                         test::drive_past_bushes(3, 2));
  };
  // The beams come from another world; the test only asks that fewer trees give other answers.
  EXPECT_NE(answered(1).objective, answered(0.1).objective);
  EXPECT_EQ(answered(1).objective, answered(1).objective);
  // The density that made the composed scene answers the log of that scene best.
  const primitives::Composition truth = primitives::compose(site, ground, read, {});
  BeamLog log = test::drive_past_bushes(4, 4);
  simulate::Options options;
  options.seed = 99;
  simulate::simulate(trace::World(truth.scene), options, 0, log);
  const auto objective = [&](double density) {
    return scene_outcome("packet_f1", parts, {}, densities, std::vector<double>{density}, log)
        .objective;
  };
  EXPECT_LT(objective(1), objective(0.3));
  EXPECT_LT(objective(1), objective(2.5));
}

}  // namespace
}  // namespace underbrush::optimize
