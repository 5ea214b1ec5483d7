#include "underbrush/likelihood/likelihood.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "likelihood/beams_above_ground.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/fit/fit.hpp"
#include "underbrush/fit/part_options.hpp"
#include "underbrush/likelihood/maximisation.hpp"
#include "underbrush/metrics/predictive.hpp"

namespace underbrush::likelihood {
namespace {

elements::Ellipsoid ellipsoid(const Vec3f& mean, const Mat3& covariance, float density_per_m) {
  elements::Ellipsoid e;
  e.mean = mean;
  e.set_covariance(covariance);
  e.density_per_m = density_per_m;
  return e;
}

/// Makes a rough ground under a thin, a tilted and a dense volume.
elements::Model known_model() {
  elements::Model m;
  m.origin = Vec3(4e5, 5e6, 100);
  m.tau = 4;
  m.ground = test::level_ground(0.02);
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  m.ellipsoids = {
      ellipsoid({6, 0, 1.5f}, Vec3(0.3, 0.5, 0.2).asDiagonal(), 0.4f),
      ellipsoid({0, 7, 1.5f}, turn * Vec3(0.5, 0.1, 0.2).asDiagonal() * turn.transpose(), 1.5f),
      ellipsoid({-6, -3, 1.2f}, Vec3(0.1, 0.1, 0.3).asDiagonal(), 8.0f)};
  return m;
}

/// The beams of a sensor that drives among the volumes.
const test::BeamSpread kAmongThem{{0, 2 * M_PI}, {-0.35, 0.3}, {-4, 4}, {-2, 3}};

BeamLog log_of(const elements::Model& truth, uint64_t seed, size_t n) {
  return test::answered(test::random_beams(seed, n, kAmongThem, truth.origin), truth, seed);
}

/// Makes the known model with moved and swollen ellipsoids, and with hit probabilities instead of
/// densities.
elements::Model wrong_start() {
  elements::Model m = known_model();
  for (elements::Ellipsoid& e : m.ellipsoids) {
    e.mean += Vec3f(0.15f, -0.2f, 0.1f);
    e.set_covariance(1.6 * e.covariance_matrix() + 0.05 * Mat3::Identity());
    e.density_per_m = 0;
    e.hit.p = 0.7f;
  }
  m.ground.range_sigma_m = 0.1;
  m.ground.roughness_m = 0;
  return m;
}

/// Makes options without prior knowledge.
LikelihoodOptions plain_options() {
  LikelihoodOptions o;
  o.rounds = 60;
  o.least_gain = 1e-6;
  o.dropout = 0.001;
  o.maximisation.prior_points = o.maximisation.prior_hits = o.maximisation.spent_points = 0;
  return o;
}

/// The mean −log f of the held-out beams, nats.
double nll_of(const elements::Model& model, BeamSource& source, const credit::HeldOut& held_out) {
  return validation_nll(trace::World(model), ListedBeams(source, held_out, model, 0));
}

TEST(Likelihood, TheLastRoundsOfALongLogTakeAllBeamsAndEarlierOnesAQuarterEach) {
  const size_t many = 2 * credit::kLongLog;
  const auto share_of = [](size_t beams, int round, int rounds) {
    LikelihoodOptions options;
    options.rounds = rounds;
    return share_of_round(beams, round, options);
  };
  std::array<int, credit::BeamShare::kParts> taken{};
  for (const int round : {0, 1, 2, 3}) {
    const credit::BeamShare share = share_of(many, round, 5);
    EXPECT_FALSE(share.is_all());
    for (unsigned k = share.first; k < share.last; ++k) ++taken[k];
    EXPECT_EQ(share.weight(), 4u);
  }
  for (const int times : taken) EXPECT_EQ(times, 1);
  for (const int rounds : {1, 3, 5}) EXPECT_TRUE(share_of(many, rounds - 1, rounds).is_all());
  EXPECT_EQ(share_of(many, 0, 2), share_of(many, 3, 5));
  EXPECT_TRUE(share_of(many, 4, 20).is_all());
  EXPECT_TRUE(share_of(credit::kLongLog - 1, 0, 5).is_all());
}

TEST(Likelihood, EllipsoidsFillTheSpaceThatIsLeftOpen) {
  const BeamLog log = log_of(known_model(), 12, 20000);
  MemorySource source(log);
  const elements::Model start = wrong_start();
  RefinementLimits limits;
  limits.open.assign(start.ellipsoids.size(), Eigen::Vector3f(0.04f, 0, 2).asDiagonal());
  LikelihoodOptions options;
  options.rounds = 10;
  const elements::Model free = refine(start, source, options).model;
  const elements::Model wide = refine(start, source, options, {}, limits).model;
  for (size_t k = 0; k < wide.ellipsoids.size(); ++k) {
    const Mat3 sigma = wide.ellipsoids[k].covariance_matrix();
    EXPECT_GE(sigma(0, 0), 0.04 * (1 - 1e-5)) << k;
    EXPECT_GE(sigma(2, 2), 2 * (1 - 1e-5)) << k;
    EXPECT_LT(free.ellipsoids[k].covariance_matrix()(2, 2), 1) << k;
  }
  limits.open.pop_back();
  EXPECT_THROW(refine(start, source, options, {}, limits), std::invalid_argument);
}

TEST(Likelihood, RecoversAKnownModelFromItsBeams) {
  const elements::Model truth = known_model();
  const BeamLog log = log_of(truth, 11, 150000);
  MemorySource source(log);
  const Refined r = refine(wrong_start(), source, plain_options());
  ASSERT_EQ(r.model.ellipsoids.size(), 3u);
  for (size_t k = 0; k < 3; ++k) {
    const elements::Ellipsoid &e = r.model.ellipsoids[k], &t = truth.ellipsoids[k];
    EXPECT_LT((e.mean - t.mean).norm(), 0.05) << k;
    const Mat3 sigma = t.covariance_matrix();
    EXPECT_LT((e.covariance_matrix() - sigma).norm(), 0.12 * sigma.norm()) << k;
    EXPECT_NEAR(e.density_per_m / t.density_per_m, 1, k == 2 ? 0.25 : 0.1) << k;
  }
  EXPECT_NEAR(r.model.ground.roughness_m, 0.02, 0.003);
  EXPECT_GT(r.model.ground.hit[0].p, 0.99);
  // The fit explains held-out beams as well as the truth does.
  EXPECT_NEAR(r.report.steps.back().held_out_nll, nll_of(truth, source, credit::HeldOut{}), 0.02);
}

/// Expects that a step was accepted only if it raised the held-out likelihood, and counts these.
size_t accepted_steps(const LikelihoodReport& report, double least_gain) {
  double best = report.steps[0].held_out_nll;
  size_t accepted = 0;
  for (size_t k = 1; k < report.steps.size(); ++k) {
    const LikelihoodStep& s = report.steps[k];
    EXPECT_EQ(s.accepted, s.held_out_nll < best - least_gain) << k;
    EXPECT_EQ(s.elements, report.steps[0].elements) << k;
    if (!s.accepted) continue;
    best = s.held_out_nll;
    ++accepted;
  }
  return accepted;
}

TEST(Likelihood, EveryAcceptedStepRaisesTheHeldOutLikelihoodAndAddsNoElements) {
  const BeamLog log = log_of(known_model(), 12, 60000);
  MemorySource source(log);
  fit::FitOptions options;
  options.fitter = "likelihood";
  options.likelihood.least_gain = 1e-5;
  options.tau = 3;
  options.likelihood.rounds = 4;
  const fit::FitResult r = fit::fit(source, options);
  const LikelihoodReport& report = r.report.likelihood;
  ASSERT_GT(report.steps.size(), 3u);
  EXPECT_EQ(report.training_beams + report.held_out_beams, log.size());
  EXPECT_NEAR(double(report.held_out_beams) / double(log.size()), 0.05, 0.01);
  EXPECT_GE(accepted_steps(report, options.likelihood.least_gain), 2u);
  EXPECT_EQ(r.model.size(), report.steps[0].elements);
  EXPECT_EQ(r.model.fitter, "likelihood");
  // The model that is returned is the one that was judged best.
  double best = report.steps[0].held_out_nll;
  for (const LikelihoodStep& s : report.steps) best = s.accepted ? s.held_out_nll : best;
  EXPECT_EQ(nll_of(r.model, source, fit::likelihood_options(options).held_out), best);
  const Refined from_afar = refine(wrong_start(), source, plain_options());
  EXPECT_GT(accepted_steps(from_afar.report, plain_options().least_gain), 5u);
}

TEST(Likelihood, ABrokenMStepIsNoticedAndUndone) {
  const elements::Model truth = known_model();
  const BeamLog log = log_of(truth, 13, 20000);
  MemorySource source(log);
  LikelihoodOptions options = plain_options();
  options.rounds = 3;
  const double honest = refine(wrong_start(), source, options).report.steps.back().held_out_nll;
  // This prior of the neighbourhood overrules the beams, and the truth cannot be bettered by as
  // much as this.
  options.maximisation.prior_hits = 1e9;
  options.least_gain = 0.01;
  const Refined broken = refine(truth, source, options);
  EXPECT_EQ(broken.model.ellipsoids[0].mean, truth.ellipsoids[0].mean);
  for (size_t k = 1; k < broken.report.steps.size(); ++k) {
    EXPECT_FALSE(broken.report.steps[k].accepted) << broken.report.steps[k].name;
  }
  EXPECT_LT(honest, nll_of(wrong_start(), source, credit::HeldOut{}) - 0.1);
}

TEST(Likelihood, IsTheSameToTheBitForAnyOrderOfBeamsAndAnyNumberOfThreads) {
  const BeamLog log = log_of(known_model(), 14, 20000);
  std::vector<size_t> order(log.size());
  std::iota(order.begin(), order.end(), 0);
  Stream random(15);
  for (size_t i = order.size(); i-- > 1;) std::swap(order[i], order[random.below(i + 1)]);
  BeamLog shuffled = log.like();
  for (size_t i : order) shuffled.append(log, i);
  LikelihoodOptions options;
  options.rounds = 4;
  MemorySource source(log), other(shuffled, 777);
  const Refined a = refine(wrong_start(), source, options);
  const int threads_before = threads();
  set_threads(1);
  const Refined b = refine(wrong_start(), other, options);
  set_threads(threads_before);
  ASSERT_EQ(a.report.steps.size(), b.report.steps.size());
  for (size_t k = 0; k < a.report.steps.size(); ++k) {
    EXPECT_EQ(a.report.steps[k].held_out_nll, b.report.steps[k].held_out_nll);
    EXPECT_EQ(a.report.steps[k].training_nll, b.report.steps[k].training_nll);
  }
  for (size_t k = 0; k < a.model.ellipsoids.size(); ++k) {
    const elements::Ellipsoid &x = a.model.ellipsoids[k], &y = b.model.ellipsoids[k];
    EXPECT_EQ(x.mean, y.mean);
    EXPECT_EQ(x.covariance, y.covariance);
    EXPECT_EQ(x.density_per_m, y.density_per_m);
  }
  EXPECT_EQ(a.model.ground.roughness_m, b.model.ground.roughness_m);
}

// An ellipsoid that grows keeps the optical depth on which its hit probability was estimated.
TEST(Likelihood, TheVariancesOfTheStartGrowByTheParametersThatItsPointsPaidFor) {
  elements::Model model = known_model();
  const Mat3 before = model.ellipsoids[1].covariance_matrix();
  const auto started = [&](uint32_t hits, double spent, float density) {
    MaximisationOptions options;
    options.spent_at_start = spent;
    model.ellipsoids[1].density_per_m = density;
    model.ellipsoids[1].hit = {0.4f, hits, 30};
    return with_densities(model, 0.02, options).ellipsoids[1];
  };
  const auto growth = [&](const elements::Ellipsoid& e) {
    const Mat3 ratio = e.covariance_matrix() * before.inverse();
    EXPECT_LT((ratio - ratio(0, 0) * Mat3::Identity()).norm(), 1e-4);
    return ratio(0, 0);
  };
  const double density = started(1000000, 0, 0).density_per_m;
  for (const uint32_t hits : {0u, 1u, 2u, 3u, 10u, 1000u}) {
    EXPECT_NEAR(growth(started(hits, 0, 0)), 1, 1e-4) << hits;
    const elements::Ellipsoid grown = started(hits, 2, 0);
    const double expected = hits > 3 ? (hits + 2.0) / (hits - 2.0) : 4;
    EXPECT_NEAR(growth(grown), expected, 1e-3 * expected) << hits;
    EXPECT_NEAR(grown.density_per_m * std::sqrt(expected) / density, 1, 1e-3) << hits;
    EXPECT_NEAR(growth(started(hits, 2, 0.7f)), 1, 1e-4) << "refined before";
  }
}

TEST(Likelihood, SharpenedDecidesMoreAtTheSamePlaces) {
  constexpr double kSharpness = 2.5;
  elements::Model model = known_model();
  model.ellipsoids[0].set_covariance(0.2 * Mat3::Identity());  // a sphere
  const elements::Model sharp = sharpened(model, kSharpness);
  const BeamLog log = test::random_beams(21, 20000, kAmongThem, model.origin);
  size_t met = 0, halved = 0;
  for (size_t i = 0; i < log.size(); ++i) {
    const Vec3 origin = log.origin[i] - model.origin;
    const Vec3 direction = log.direction[i].cast<double>().normalized();
    for (uint32_t k = 0; k < 3; ++k) {
      const trace::Intersection a = trace::intersect(model, 2 + k, origin, direction, {0.2, 40});
      const trace::Intersection b = trace::intersect(sharp, 2 + k, origin, direction, {0.2, 40});
      if (a.none() || b.none()) {
        const double delta = a.none() ? b.delta2 / kSharpness : a.delta2;
        EXPECT_TRUE(a.none() == b.none() || std::abs(delta - 16) < 1e-4);
        continue;
      }
      ++met;
      EXPECT_NEAR(b.t_m, a.t_m, 1e-5);
      EXPECT_NEAR(b.sigma_m * std::sqrt(kSharpness), a.sigma_m, 1e-5);
      if (k > 0) continue;
      const double depth = -std::log1p(-a.p);
      const double expected = -std::expm1(-M_LN2 * std::pow(depth / M_LN2, kSharpness));
      EXPECT_NEAR(b.p, expected, 1e-4);
      EXPECT_TRUE(a.p < 0.5 ? b.p <= a.p : b.p >= a.p - 1e-4) << a.p;
      halved += a.p < 0.5 && b.p < a.p;
    }
  }
  EXPECT_GT(met, 1000u);
  EXPECT_GT(halved, 100u);
}

TEST(Likelihood, SharpnessNarrowsTheDrawAndLeavesTheStepsAlone) {
  const BeamLog log = log_of(known_model(), 22, 20000);
  MemorySource source(log);
  LikelihoodOptions options;
  options.rounds = 9;
  const Refined plain = refine(wrong_start(), source, options);
  options.sharpness = 2;
  const Refined sharp = refine(wrong_start(), source, options);
  ASSERT_EQ(sharp.report.steps.size(), plain.report.steps.size());
  EXPECT_EQ(sharp.report.steps.back().held_out_nll, plain.report.steps.back().held_out_nll);
  EXPECT_DOUBLE_EQ(sharp.model.tau, plain.model.tau * std::sqrt(2));
  EXPECT_EQ(sharp.model.ellipsoids[0].mean, plain.model.ellipsoids[0].mean);
  // The log was drawn from the model without sharpening, so sharpening can only lower the
  // likelihood.
  EXPECT_GT(nll_of(sharp.model, source, credit::HeldOut{}),
            nll_of(plain.model, source, credit::HeldOut{}));
}

TEST(Likelihood, RefusesWhatItCannotRefine) {
  const BeamLog log = log_of(known_model(), 16, 200);
  MemorySource source(log);
  elements::Model bounded = wrong_start();
  bounded.voxel_m = 0.3;
  EXPECT_THROW(refine(bounded, source, {}), std::invalid_argument);
  LikelihoodOptions nothing_held_out;
  nothing_held_out.held_out.one_in = 0;
  EXPECT_THROW(refine(wrong_start(), source, nothing_held_out), std::invalid_argument);
  LikelihoodOptions dull;
  dull.sharpness = 0;
  EXPECT_THROW(refine(wrong_start(), source, dull), std::invalid_argument);
  fit::FitOptions circle;
  circle.fitter = circle.start = "likelihood";
  EXPECT_THROW(fit::fit(source, circle), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::likelihood
