#include "underbrush/metrics/score.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "underbrush/core/rng.hpp"
#include "underbrush/metrics/nearest.hpp"

namespace underbrush::metrics {
namespace {

BeamLog fan(const std::vector<float>& ranges) {
  BeamLog log;
  log.info.max_range_m = 100;
  log.info.has_misses = true;
  log.resize(ranges.size());
  for (size_t i = 0; i < ranges.size(); ++i) {
    log.direction[i] = Vec3f(std::cos(0.3f * float(i)), std::sin(0.3f * float(i)), 0);
    log.packet[i] = uint32_t(i / 2);
  }
  log.range_m = ranges;
  return log;
}

Score score_of(const BeamLog& real, const BeamLog& sim, const ScoreOptions& options = {},
               size_t real_chunk = 1000, size_t sim_chunk = 1000) {
  MemorySource a(real, real_chunk), b(sim, sim_chunk);
  return score(a, b, options);
}

TEST(Score, OfALogWithItselfIsPerfect) {
  const BeamLog log = fan({1, 2, 3, kMiss, 5, 6});
  const Summary s = score_of(log, log).all;
  EXPECT_EQ(s.true_hits, 5u);
  EXPECT_EQ(s.true_misses, 1u);
  EXPECT_EQ(s.f1, 1);
  EXPECT_EQ(s.packet_error_m, 0);
  EXPECT_EQ(s.cloud_error_m, 0);
  EXPECT_EQ(s.density_aware_chamfer, 0);
}

TEST(Score, CountsAndErrorsAreThoseOfThePaperByHand) {
  const BeamLog real = fan({10, 10, 10, kMiss, kMiss, 10, 10, 10});
  const BeamLog sim = fan({11, 13, kMiss, 10, kMiss, 10, 10.5f, kMiss});
  const Summary s = score_of(real, sim).all;
  EXPECT_EQ(s.true_hits, 4u);
  EXPECT_EQ(s.false_hits, 1u);
  EXPECT_EQ(s.false_misses, 2u);
  EXPECT_EQ(s.true_misses, 1u);
  EXPECT_DOUBLE_EQ(s.precision, 4.0 / 5);
  EXPECT_DOUBLE_EQ(s.recall, 4.0 / 6);
  EXPECT_DOUBLE_EQ(s.f1, 2 * 0.8 * (4.0 / 6) / (0.8 + 4.0 / 6));
  EXPECT_DOUBLE_EQ(s.recall_of_misses, 1.0 / 2);
  EXPECT_DOUBLE_EQ(s.precision_of_misses, 1.0 / 3);
  EXPECT_DOUBLE_EQ(s.f1_of_misses, 2.0 / 5);
  EXPECT_DOUBLE_EQ(s.informedness, 4.0 / 6 + 1.0 / 2 - 1);
  // The packets have errors (1, 3), none, (0) and (0.5), with means 2, none, 0 and 0.5.
  EXPECT_NEAR(s.packet_error_m, (2 + 0 + 0.5) / 3, 1e-6);
  // Errors 1, 3 (counts as 2), 2 for each of three wrong hits and misses, 0, 0 and 0.5 of eight
  // beams.
  EXPECT_NEAR(s.capped_error_m, (1 + 2 + 2 + 2 + 0 + 0 + 0.5 + 2) / 8, 1e-6);
}

Summary counted(size_t true_hits, size_t false_hits, size_t false_misses, size_t true_misses) {
  Summary s;
  s.true_hits = true_hits;
  s.false_hits = false_hits;
  s.false_misses = false_misses;
  s.true_misses = true_misses;
  score_counts(s);
  return s;
}

TEST(ScoreCounts, OfSimulatorsThatNeedNoWorldAreKnown) {
  const Summary perfect = counted(950, 0, 0, 50), inverted = counted(0, 50, 950, 0);
  EXPECT_EQ(perfect.informedness, 1);
  EXPECT_EQ(perfect.f1_of_misses, 1);
  EXPECT_EQ(inverted.informedness, -1);
  EXPECT_EQ(inverted.f1_of_misses, 0);
  EXPECT_EQ(inverted.precision_of_misses, 0);
  const Summary hits = counted(950, 50, 0, 0), misses = counted(0, 0, 950, 50);
  EXPECT_GT(hits.f1, 0.97);  // It ties good simulators, which is why the others are there.
  EXPECT_EQ(hits.informedness, 0);
  EXPECT_EQ(hits.f1_of_misses, 0);
  EXPECT_TRUE(std::isnan(hits.precision_of_misses));
  EXPECT_EQ(misses.informedness, 0);
  EXPECT_EQ(misses.recall_of_misses, 1);
  EXPECT_DOUBLE_EQ(misses.precision_of_misses, 0.05);
  EXPECT_DOUBLE_EQ(misses.f1_of_misses, 2 * 50.0 / (50 + 1000));
}

TEST(ScoreCounts, GuessingWithoutLookingHasNoInformedness) {
  // A share p of both the hits and the misses is answered with a hit.
  for (const size_t percent : {10, 50, 90}) {
    const Summary s = counted(95 * percent, 5 * percent, 95 * (100 - percent), 5 * (100 - percent));
    EXPECT_NEAR(s.informedness, 0, 1e-12) << percent;
    EXPECT_NEAR(s.precision_of_misses, 0.05, 1e-12);
  }
}

TEST(ScoreCounts, SwappingHitsAndMissesSwapsTheirScores) {
  const Summary a = counted(70, 7, 11, 12), b = counted(12, 11, 7, 70);
  EXPECT_DOUBLE_EQ(a.f1_of_misses, b.f1);
  EXPECT_DOUBLE_EQ(a.precision_of_misses, b.precision);
  EXPECT_DOUBLE_EQ(a.recall_of_misses, b.recall);
  EXPECT_DOUBLE_EQ(a.informedness, b.informedness);
  EXPECT_DOUBLE_EQ(a.informedness, 70.0 / 81 - 7.0 / 19);  // Recall minus the share of false hits.
}

TEST(ScoreCounts, AreUnknownWhereAllBeamsHaveOneOutcome) {
  const Summary hits = counted(90, 0, 10, 0), misses = counted(0, 3, 0, 7),
                none = counted(0, 0, 0, 0);
  for (const Summary& s : {hits, misses, none}) {
    EXPECT_TRUE(std::isnan(s.informedness));
    EXPECT_TRUE(std::isnan(s.f1_of_misses));
    EXPECT_TRUE(std::isnan(s.precision_of_misses));
  }
  EXPECT_TRUE(std::isnan(hits.recall_of_misses));
  EXPECT_DOUBLE_EQ(hits.recall, 0.9);
  EXPECT_DOUBLE_EQ(misses.recall_of_misses, 0.7);
}

TEST(Score, LeavesOutBeamsThatMetSomethingThatMoved) {
  BeamLog real = fan({10, 10, 4, kMiss, 10, 3});
  const BeamLog sim = fan({11, 10, 10, kMiss, 10, kMiss});
  real.flags[2] = real.flags[5] = kMover;
  const Score s = score_of(real, sim);
  EXPECT_EQ(s.mover_beams, 2u);
  EXPECT_EQ(s.all.beams, 4u);
  EXPECT_EQ(s.all.f1, 1);
  EXPECT_DOUBLE_EQ(s.all.packet_error_m, (0.5 + 0) / 2);
}

TEST(Score, NoChoiceOfHitsFlattersTheCappedError) {
  // To miss where one is unsure makes the packet error smaller, but not the capped one.
  const BeamLog real = fan({10, 10, 10, 10}), brave = fan({10, 10, 10, 14});
  const BeamLog shy = fan({10, 10, 10, kMiss});
  EXPECT_LT(score_of(real, shy).all.packet_error_m, score_of(real, brave).all.packet_error_m);
  EXPECT_EQ(score_of(real, shy).all.capped_error_m, score_of(real, brave).all.capped_error_m);
}

TEST(Score, TellsTheRoughnessOfBothLogs) {
  const Score s = score_of(fan({10, 10, 10.1f}), fan({10, 11, 10}));
  EXPECT_NEAR(s.real_roughness_m, 0.1, 1e-5);
  EXPECT_NEAR(s.roughness_m, 2, 1e-5);
}

TEST(Score, CloudErrorIsInMetresNotSquared) {
  const BeamLog real = fan({10}), sim = fan({13});
  EXPECT_NEAR(score_of(real, sim).all.cloud_error_m, 3, 1e-6);
}

TEST(Score, DoesNotDependOnHowTheLogsAreChunked) {
  const BeamLog real = fan({10, 10, 10, kMiss, kMiss, 10, 10, 10});
  const BeamLog sim = fan({11, 13, kMiss, 10, kMiss, 10, 10.5f, kMiss});
  const Summary one = score_of(real, sim).all;
  for (size_t a : {1, 3, 5}) {
    for (size_t b : {1, 2, 7}) {
      const Summary s = score_of(real, sim, {}, a, b).all;
      EXPECT_EQ(s.true_hits, one.true_hits);
      EXPECT_EQ(s.packet_error_m, one.packet_error_m);
      EXPECT_EQ(s.cloud_error_m, one.cloud_error_m);
      EXPECT_EQ(s.capped_error_m, one.capped_error_m);
    }
  }
}

TEST(Score, SplitsByClassAndRange) {
  BeamLog real = fan({5, 15, 15, kMiss});
  real.extra["class"] = std::vector<uint16_t>{1, 1, 2, 0};
  const BeamLog sim = fan({5, 16, kMiss, kMiss});
  const Score s = score_of(real, sim);
  EXPECT_EQ(s.per_class.at("1").true_hits, 2u);
  EXPECT_EQ(s.per_class.at("2").false_misses, 1u);
  real.info.classes = "underbrush";
  EXPECT_EQ(score_of(real, sim).per_class.at("ground").true_hits, 2u);
  real.extra["class"] = std::vector<uint16_t>{40, 40, 123, 0};
  real.info.classes = "semantickitti";
  EXPECT_EQ(score_of(real, sim).per_class.at("road").true_hits, 2u);
  EXPECT_EQ(score_of(real, sim).per_class.at("123").false_misses, 1u);
  EXPECT_EQ(s.per_range.at("0-10").beams, 1u);
  EXPECT_EQ(s.per_range.at("10-20").beams, 2u);
  EXPECT_EQ(s.per_range.at("miss").true_misses, 1u);
  EXPECT_EQ(s.per_range.at("miss").recall_of_misses, 1);
  EXPECT_TRUE(std::isnan(s.per_range.at("10-20").informedness));
  EXPECT_NEAR(s.per_range.at("10-20").packet_error_m, 1, 1e-6);
}

TEST(Score, RefusesLogsOfOtherBeams) {
  const BeamLog real = fan({1, 2, 3});
  EXPECT_THROW(score_of(real, fan({1, 2})), std::invalid_argument);
  BeamLog other = real;
  other.origin[1].x() += 1;
  EXPECT_THROW(score_of(real, other), std::invalid_argument);
}

TEST(Score, LikelihoodPrefersTheModelThatMadeTheBeams) {
  elements::Model good, bad;
  elements::Ellipsoid e;
  e.mean = Vec3f(10, 0, 0);
  e.set_covariance(0.04 * Mat3::Identity());
  e.hit.p = 0.5f;
  good.ellipsoids = bad.ellipsoids = {e};
  bad.ellipsoids[0].hit.p = 1;
  BeamLog real;
  real.info.max_range_m = 50;
  real.resize(1000);
  Stream random(2);
  for (size_t i = 0; i < real.size(); ++i) {
    const bool hit = random.uniform() < 0.5;
    real.range_m[i] = hit ? float(10 + 0.2 * random.normal()) : kMiss;
  }
  const trace::World good_world(good), bad_world(bad);
  ScoreOptions options;
  options.world = &good_world;
  const Score of_good = score_of(real, real, options);
  options.world = &bad_world;
  const Score of_bad = score_of(real, real, options);
  const Summary &a = of_good.all, &b = of_bad.all;
  EXPECT_LT(of_good.reliability.error(), 0.04);
  EXPECT_NEAR(of_bad.reliability.error(), 0.5, 0.05);
  EXPECT_EQ(of_bad.reliability.beams(), real.size());
  EXPECT_LT(a.nll_per_beam, b.nll_per_beam);
  EXPECT_LT(a.crps_m, b.crps_m);
  // The entropy of the truth without outliers is ½(ln 2 + ln 2 + ½ ln(2πe σ²)).
  EXPECT_NEAR(a.nll_per_beam, std::log(2) + 0.25 * std::log(2 * M_PI * M_E * 0.04), 0.06);
}

TEST(Score, LikelihoodIsOfTheRealLogAlone) {
  // So the objective nll of `optimize` does not depend on how its beams were simulated.
  elements::Model model;
  elements::Ellipsoid e;
  e.mean = Vec3f(10, 0, 0);
  e.set_covariance(0.04 * Mat3::Identity());
  e.hit.p = 0.5f;
  model.ellipsoids = {e};
  BeamLog real;
  real.info.max_range_m = 50;
  real.resize(20);
  for (size_t i = 0; i < real.size(); ++i) real.range_m[i] = i % 2 ? 10 + 0.01f * float(i) : kMiss;
  BeamLog other = real;
  std::reverse(other.range_m.begin(), other.range_m.end());
  const trace::World world(model);
  ScoreOptions options;
  options.world = &world;
  const Summary a = score_of(real, real, options).all, b = score_of(real, other, options).all;
  EXPECT_NE(a.informedness, b.informedness);
  EXPECT_EQ(a.nll_per_beam, b.nll_per_beam);
  EXPECT_EQ(a.crps_m, b.crps_m);
}

TEST(Nearest, EqualsBruteForce) {
  Stream random(3);
  std::vector<Vec3f> a, b;
  for (int i = 0; i < 700; ++i) {
    for (auto* cloud : {&a, &b}) {
      const double x = random.normal(), y = random.normal(), z = random.normal();
      cloud->emplace_back(float(x), float(y), float(z));
    }
  }
  const Nearest n = nearest(a, b);
  for (size_t i = 0; i < a.size(); ++i) {
    float least = INFINITY;
    for (const Vec3f& p : b) least = std::min(least, (p - a[i]).norm());
    EXPECT_NEAR(n.distance_m[i], least, 1e-6);
  }
}

TEST(RangeErrorHistogram, PutsEachErrorInItsBin) {
  RangeErrorHistogram h;
  h.add(-5);
  h.add(0.01);
  h.add(-0.01);
  h.add(5);
  EXPECT_EQ(h.count.front(), 1u);
  EXPECT_EQ(h.count.back(), 1u);
  EXPECT_EQ(h.count[1 + 40], 1u);
  EXPECT_EQ(h.count[1 + 39], 1u);
}

}  // namespace
}  // namespace underbrush::metrics
