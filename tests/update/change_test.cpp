#include "underbrush/update/change.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace underbrush::update {
namespace {

TEST(Change, EvidenceOfSingleTrialsIsTheClosedForm) {
  // B(2, 1) B(1, 2) / B(2, 2) = (1/2 · 1/2) / (1/6), and B(2, 1)² / B(3, 1) = (1/4) / (1/3).
  EXPECT_NEAR(change_evidence({1, 0}, {0, 1}), std::log(1.5), 1e-12);
  EXPECT_NEAR(change_evidence({1, 0}, {1, 0}), std::log(0.75), 1e-12);
}

TEST(Change, EvidenceIsSymmetricAndNothingWithoutTrials) {
  for (const credit::Trials a :
       {credit::Trials{3, 0}, credit::Trials{40, 200}, credit::Trials{0, 7}}) {
    for (const credit::Trials b :
         {credit::Trials{0, 0}, credit::Trials{9, 1}, credit::Trials{500, 2}}) {
      EXPECT_DOUBLE_EQ(change_evidence(a, b), change_evidence(b, a));
      EXPECT_NEAR(change_evidence({a.misses, a.hits}, {b.misses, b.hits}), change_evidence(a, b),
                  1e-9);
    }
    EXPECT_NEAR(change_evidence(a, {}), 0, 1e-12);
  }
}

// Any number of beams of one log is at most 20 independent ones, so no number of them makes a
// change of small differences.
TEST(Change, SmallDifferencesOfManyBeamsAreNoEvidence) {
  EXPECT_LT(change_evidence({6000, 4000}, {4000, 6000}), 1);
  EXPECT_LT(change_evidence({300, 0}, {200, 30}), 1);
  EXPECT_GT(change_evidence({9000, 1000}, {500, 9500}), kChangeEvidence);
}

/// Ellipsoids in a row, `step_m` from one another.
std::vector<elements::Ellipsoid> row(size_t n, float step_m) {
  std::vector<elements::Ellipsoid> out(n);
  for (size_t k = 0; k < n; ++k) out[k].mean = Vec3f(step_m * float(k), 0.1f, 0.1f);
  return out;
}

std::vector<CurrentTrials> after(const std::vector<elements::Ellipsoid>& ellipsoids,
                                 const std::vector<credit::Trials>& earlier,
                                 const std::vector<credit::Trials>& later) {
  std::vector<CurrentTrials> of(earlier.size());
  for (size_t k = 0; k < of.size(); ++k) of[k].trials = earlier[k];
  add_trials(ellipsoids, later, {}, of);
  return of;
}

TEST(Change, WhatHasGoneAndWhatHasComeCountsByTheLaterTrialsAlone) {
  const auto of = after(row(2, 100), {{500, 0}, {0, 500}}, {{0, 300}, {100, 10}});
  EXPECT_TRUE(of[0].changed && of[0].gone);
  EXPECT_EQ(of[0].trials.hits, 0u);
  EXPECT_EQ(of[0].trials.misses, 300u);
  EXPECT_TRUE(of[1].changed && !of[1].gone);
  EXPECT_EQ(of[1].trials.hits, 100u);
  EXPECT_EQ(of[1].trials.misses, 10u);
}

TEST(Change, WhatIsTheSameAddsUp) {
  const auto of = after(row(2, 0.1f), {{50, 10}, {5, 5}}, {{20, 5}, {0, 0}});
  EXPECT_FALSE(of[0].changed || of[1].changed);
  EXPECT_EQ(of[0].trials.hits, 70u);
  EXPECT_EQ(of[0].trials.misses, 15u);
  EXPECT_EQ(of[1].trials.hits, 5u);
}

// Nine beams through one ellipsoid tell too little, but not those through all of a thing. Another
// thing beside it, which is as before, stays.
TEST(Change, EvidenceOfNeighboursIsSummed) {
  const std::vector<credit::Trials> hit(8, credit::Trials{20, 2}), passed(8, credit::Trials{0, 9});
  for (const auto& [step, changed] : {std::pair{100.f, false}, std::pair{0.1f, true}}) {
    for (const CurrentTrials& now : after(row(8, step), hit, passed)) {
      EXPECT_EQ(now.changed, changed);
      EXPECT_EQ(now.gone, changed);
    }
  }
  std::vector<credit::Trials> some = passed;
  for (size_t k = 0; k < 8; k += 2) some[k] = {8, 1};
  const auto of = after(row(8, 0.1f), hit, some);
  for (size_t k = 0; k < 8; ++k) EXPECT_EQ(of[k].gone, k % 2 == 1) << k;
}

// A part of a thing that no later beam met goes with the others, and one that is alone stays.
TEST(Change, WhatIsNotMetGoesWithItsNeighbours) {
  for (const auto& [step, gone] : {std::pair{100.f, false}, std::pair{0.1f, true}}) {
    std::vector<credit::Trials> later(8, credit::Trials{0, 9});
    later[3] = {0, 0};
    const auto of = after(row(8, step), std::vector<credit::Trials>(8, {20, 2}), later);
    EXPECT_EQ(of[3].gone, gone);
    EXPECT_EQ(of[3].trials.hits, gone ? 0u : 20u);
  }
}

TEST(Change, WhatHasGoneStaysAwayUntilBeamsEndThere) {
  const auto ellipsoids = row(8, 0.1f);
  auto of = after(ellipsoids, std::vector<credit::Trials>(8, {20, 2}),
                  std::vector<credit::Trials>(8, {0, 9}));
  add_trials(ellipsoids, std::vector<credit::Trials>(8, {0, 1}), {}, of);
  for (const CurrentTrials& now : of) EXPECT_TRUE(now.gone && !now.changed);
  add_trials(ellipsoids, std::vector<credit::Trials>(8, {9, 0}), {}, of);
  for (const CurrentTrials& now : of) EXPECT_FALSE(now.gone);
}

}  // namespace
}  // namespace underbrush::update
