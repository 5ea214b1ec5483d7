// Tests of `update`: which tiles are fitted anew, and what has gone or come.
#include <gtest/gtest.h>

#include <array>
#include <set>

#include "update_site.hpp"

namespace underbrush::update {
namespace {

/// The beams of a log that end beyond `least_x`, less than 20 m away.
BeamLog near_returns(const BeamLog& log, double least_x) {
  BeamLog out = log.like();
  for (size_t i = 0; i < log.size(); ++i) {
    if (log.range_m[i] < 20 && log.end_point(i).x() > least_x && log.direction[i].x() > 0) {
      out.append(log, i);
    }
  }
  return out;
}

TEST(Update, TilesOutOfReachKeepTheirElementsBitForBit) {
  const BeamLog a = drive(true, 1, 20000), b = near_returns(drive(true, 2, 60000), 17);
  ASSERT_GT(b.size(), 100u);
  const fit::FitResult known = fitted(a);
  const UpdateResult u = updated(known, {&a}, b, kAtOnce);
  EXPECT_GT(u.report.fitted_tiles, 0u);
  EXPECT_LT(u.report.fitted_tiles, u.report.tiles);
  // Returns lie beyond x = 17 m, the margin is 10 m, and tiles begin at −6 m and are 12 m long.
  std::set<std::array<float, 3>> found;
  const auto key = [](const elements::Ellipsoid& e) {
    return std::array{e.mean.x(), e.mean.y(), e.mean.z()};
  };
  size_t far = 0;
  for (const elements::Ellipsoid& e : u.model.ellipsoids) found.insert(key(e));
  for (const elements::Ellipsoid& e : known.model.ellipsoids) {
    if (e.mean.x() + known.model.origin.x() > 4) continue;
    EXPECT_TRUE(found.count(key(e)));
    ++far;
  }
  EXPECT_GT(far, 20u);
  EXPECT_LE(far, u.report.kept);
}

// Few returns change counts and nothing else; later ones make the tile due.
TEST(Update, TilesAreFittedAnewOnceTheyHaveGrown) {
  const BeamLog a = drive(true, 1, 20000), b = drive(true, 2, 3000), c = drive(true, 3, 6000);
  const UpdateOptions refitting{0.4, 1};
  const fit::FitResult known = fitted(a);
  const UpdateResult first = updated(known, {&a}, b, refitting);
  std::set<std::array<float, 3>> before;
  for (const auto& e : known.model.ellipsoids) before.insert({e.mean.x(), e.mean.y(), e.mean.z()});
  uint64_t trials_before = 0, trials_now = 0;
  for (const auto& e : known.model.ellipsoids) trials_before += e.hit.hits + e.hit.misses;
  for (const auto& e : first.model.ellipsoids) trials_now += e.hit.hits + e.hit.misses;
  EXPECT_GT(trials_now, trials_before + trials_before / 20);
  const auto anew = [&](const UpdateResult& u) {
    return double(u.report.fitted_tiles) / double(u.report.tiles);
  };
  EXPECT_LT(anew(first), 0.3);
  const UpdateResult second = updated(as_fit(first), {&a, &b}, c, refitting);
  EXPECT_GT(anew(second), 0.5);
}

TEST(Update, ACarThatHasGoneVanishesAndTheRestRemains) {
  const BeamLog with = drive(true, 1, 60000), without = drive(false, 2, 30000);
  for (const std::string fitter : {"hierarchical", "likelihood"}) {
    const fit::FitOptions options = small_tiles(fitter);
    const fit::FitResult known = fitted(with, options);
    ASSERT_GT(ellipsoids_of_car(known.model), 30u);
    ASSERT_GT(opacity_towards(known.model, kCar), 0.95);
    // A refined car leaves some rims that beams hardly met.
    const size_t rims = fitter == "likelihood" ? 12 : 20;
    const fit::FitResult one = fitted(joined(with, without), options);
    EXPECT_GT(ellipsoids_of_car(one.model), 30u);  // one fit averages over time
    for (const double growth : {0.0, 0.25, 10.0}) {
      const UpdateResult u =
          updated(known, {&with}, without, {growth, growth}, size_t(1) << 20, options);
      EXPECT_LE(ellipsoids_of_car(u.model), ellipsoids_of_car(known.model) / rims);
      EXPECT_LT(opacity_towards(u.model, kCar), 0.05);
      EXPECT_GT(u.report.gone, 20u);
      ASSERT_FALSE(u.report.places.empty());
      EXPECT_LT((u.report.places[0].centre - kCar).norm(), 3);
      for (const Vec3& bush : {Vec3(-4, -8, 1.2), Vec3(-8, 10, 1.2)}) {
        if (fitter == "likelihood") {
          // No tile is due at a growth of 10: then ellipsoids have the shapes that they had.
          const elements::Model& like = growth < 1 ? one.model : known.model;
          EXPECT_NEAR(mean_opacity(u.model, bush), mean_opacity(like, bush), 0.1);
        } else {
          EXPECT_NEAR(opacity_towards(u.model, bush), opacity_towards(known.model, bush), 0.1);
        }
      }
    }
  }
}

TEST(Update, ACarThatHasComeIsOpaque) {
  const BeamLog without = drive(false, 1, 60000), with = drive(true, 2, 30000);
  for (const std::string fitter : {"hierarchical", "likelihood"}) {
    const fit::FitOptions options = small_tiles(fitter);
    const UpdateResult u =
        updated(fitted(without, options), {&without}, with, {}, size_t(1) << 20, options);
    EXPECT_GT(ellipsoids_of_car(u.model), 20u);
    EXPECT_GT(opacity_towards(u.model, kCar), 0.9);
  }
}

// The car does not come back when its tile is fitted anew, to the points of the first log, too.
TEST(Update, WhatHasGoneStaysAway) {
  const BeamLog with = drive(true, 1, 40000), without = drive(false, 2, 20000),
                little = drive(false, 3, 2000);
  const UpdateResult first = updated(fitted(with), {&with}, without, kAtOnce);
  const UpdateResult second = updated(as_fit(first), {&with, &without}, little, kAtOnce);
  EXPECT_GT(second.report.fitted_tiles, 0u);
  EXPECT_LE(ellipsoids_of_car(second.model), ellipsoids_of_car(fitted(with).model) / 10);
}

}  // namespace
}  // namespace underbrush::update
