#include "underbrush/fit/update.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "drive_past.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/fit/kept_triangles.hpp"
#include "underbrush/metrics/score.hpp"

namespace underbrush::fit {
namespace {

const Vec3 kCar(3, 7, 0.9);

/// A box on the ground about `kCar`.
elements::TriangleMesh car() {
  elements::TriangleMesh mesh;
  for (int k = 0; k < 8; ++k) {
    const Vec3 half(k & 1 ? 1.8 : -1.8, k & 2 ? 0.8 : -0.8, k & 4 ? 0.7 : -0.7);
    mesh.vertices.push_back((kCar + half).cast<float>());
  }
  mesh.triangles = {{0, 1, 5}, {0, 5, 4}, {2, 3, 7}, {2, 7, 6}, {0, 2, 6},
                    {0, 6, 4}, {1, 3, 7}, {1, 7, 5}, {4, 5, 7}, {4, 7, 6}};
  mesh.hit.resize(mesh.size());
  mesh.range_sigma_m = 0.02;
  return mesh;
}

/// Ground, a permeable bush and a dense one, and a parked car where there is one.
elements::Model site(bool with_car) {
  elements::Model truth = test::flat_ground(60);
  test::add_bush({-4, -8, 1.2f}, {0.3, 0.3, 0.2}, 0.5f, truth);
  test::add_bush({-8, 10, 1.2f}, {0.3, 0.3, 0.2}, 0.95f, truth);
  if (with_car) truth.surface = car();
  return truth;
}

BeamLog drive(bool with_car, uint64_t seed, size_t beams) {
  return test::drive_past(site(with_car), seed, beams, 3000, -0.4);
}

BeamLog joined(const BeamLog& a, const BeamLog& b) {
  BeamLog out = a;
  out.append(b, 0, b.size());
  return out;
}

FitOptions small_tiles(const std::string& fitter = "likelihood") {
  FitOptions options;
  options.fitter = fitter;
  options.tiles.tile_m = 12;
  return options;
}

FitResult fitted(const BeamLog& log, const FitOptions& options = small_tiles()) {
  MemorySource source(log);
  return fit(source, options);
}

constexpr UpdateOptions kAtOnce{0, 0};

UpdateResult updated(FitResult known, const std::vector<const BeamLog*>& logs, const BeamLog& more,
                     const UpdateOptions& how, size_t chunk = 1 << 20,
                     const FitOptions& options = small_tiles()) {
  std::vector<MemorySource> sources;
  sources.reserve(logs.size());
  std::vector<BeamSource*> given;
  for (const BeamLog* log : logs) {
    sources.emplace_back(*log, chunk);
    given.push_back(&sources.back());
  }
  MemorySource added(more, chunk);
  return update(std::move(known), given, added, options, how);
}

FitResult as_fit(const UpdateResult& u) { return {u.model, {}, u.record}; }

bool same(const elements::Ellipsoid& a, const elements::Ellipsoid& b) {
  return a.mean == b.mean && a.covariance == b.covariance && a.hit.hits == b.hit.hits &&
         a.hit.misses == b.hit.misses && a.hit.p == b.hit.p;
}

void expect_same_ellipsoids(const elements::Model& a, const elements::Model& b) {
  ASSERT_EQ(a.ellipsoids.size(), b.ellipsoids.size());
  for (size_t i = 0; i < a.ellipsoids.size(); ++i) {
    ASSERT_TRUE(same(a.ellipsoids[i], b.ellipsoids[i])) << i;
  }
}

void expect_same_ground(const elements::TriangleMesh& a, const elements::TriangleMesh& b) {
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.triangles, b.triangles);
}

/// The chance that a beam from the drive's middle to a place ends on an ellipsoid.
double opacity_towards(const elements::Model& model, const Vec3& target) {
  const trace::World world(model);
  const Vec3 origin(0, 0, 1.8);
  std::vector<trace::Intersection> met;
  world.all_intersections({origin, (target - origin).normalized()}, {0, 30}, 30, met);
  double through = 1;
  for (const auto& m : met) {
    if (model.kind(m.element) == elements::Kind::kEllipsoid) through *= 1 - m.p;
  }
  return 1 - through;
}

/// The mean of `opacity_towards` places around one.
double mean_opacity(const elements::Model& model, const Vec3& target) {
  double sum = 0;
  for (int k = 0; k < 25; ++k) {
    sum += opacity_towards(model, target + Vec3(0.1 * (k % 5 - 2), 0, 0.1 * (k / 5 - 2)));
  }
  return sum / 25;
}

size_t ellipsoids_of_car(const elements::Model& model) {
  return size_t(std::count_if(model.ellipsoids.begin(), model.ellipsoids.end(), [&](const auto& e) {
    const Vec3 from = e.mean.template cast<double>() + model.origin - kCar;
    return std::abs(from.x()) < 2.5 && std::abs(from.y()) < 1.5 && from.z() > -0.5;
  }));
}

TEST(Update, WithoutScansNothingChanges) {
  const BeamLog a = drive(true, 1, 20000), none = a.like();
  const FitResult known = fitted(a);
  const UpdateResult u = updated(known, {&a}, none, kAtOnce);
  expect_same_ellipsoids(u.model, known.model);
  expect_same_ground(u.model.ground, known.model.ground);
  EXPECT_EQ(u.report.kept, known.model.ellipsoids.size());
  ASSERT_EQ(u.report.warnings.size(), 1u);
}

// With growth 0 the elements are those of one fit, bit for bit, and so are their counts where the
// world stays as it is.
TEST(Update, AtOnceIsOneFitOfAllScans) {
  const BeamLog a = drive(true, 1, 20000), b = drive(true, 2, 15000);
  for (const std::string fitter : {"hierarchical", "voxel", "top_down", "bottom_up"}) {
    FitOptions options = small_tiles();
    options.fitter = fitter;
    const FitResult all = fitted(joined(a, b), options);
    const UpdateResult u = updated(fitted(a, options), {&a}, b, kAtOnce, size_t(1) << 20, options);
    EXPECT_EQ(u.report.changed, 0u);
    EXPECT_EQ(u.report.fitted_tiles, u.record.tiles.size());
    expect_same_ellipsoids(u.model, all.model);
    expect_same_ground(u.model.ground, all.model.ground);
    EXPECT_EQ(u.model.max_range_m, all.model.max_range_m);
    EXPECT_NEAR(u.model.ground.range_sigma_m, all.model.ground.range_sigma_m, 1e-3);
    EXPECT_NEAR(u.model.ground.roughness_m, all.model.ground.roughness_m, 1e-3);
    ASSERT_EQ(u.record.tiles.size(), all.record.tiles.size());
    for (size_t k = 0; k < u.record.tiles.size(); ++k) {
      EXPECT_EQ(u.record.tiles[k].points, all.record.tiles[k].points);
      EXPECT_EQ(u.record.tiles[k].ellipsoids, all.record.tiles[k].ellipsoids);
    }
    for (size_t t = 0; t < u.model.ground.size(); ++t) {
      EXPECT_NEAR(u.model.ground.hit[t].p, all.model.ground.hit[t].p, 0.02);
    }
  }
}

TEST(Update, TwoUpdatesAreOneUpdateWithBoth) {
  const BeamLog a = drive(true, 1, 20000), b = drive(true, 2, 15000), c = drive(true, 3, 15000);
  const BeamLog both = joined(b, c);
  const FitOptions options = small_tiles("hierarchical");
  const auto added = [&](FitResult known, const std::vector<const BeamLog*>& logs,
                         const BeamLog& more) {
    return updated(std::move(known), logs, more, kAtOnce, size_t(1) << 20, options);
  };
  const UpdateResult one = added(fitted(a, options), {&a}, both);
  const UpdateResult first = added(fitted(a, options), {&a}, b);
  const UpdateResult two = added(as_fit(first), {&a, &b}, c);
  EXPECT_EQ(one.report.changed + first.report.changed + two.report.changed, 0u);
  expect_same_ellipsoids(two.model, one.model);
  expect_same_ground(two.model.ground, one.model.ground);
}

// The triangles that a refined ground keeps have their roughness, others that of the mesh.
TEST(Update, TheGroundKeepsItsNoise) {
  const BeamLog a = drive(true, 1, 20000), b = drive(true, 2, 15000);
  const FitResult known = fitted(a);
  const elements::TriangleMesh& before = known.model.ground;
  ASSERT_EQ(before.roughness.size(), before.size());
  const auto [least, most] = std::minmax_element(before.roughness.begin(), before.roughness.end());
  EXPECT_LT(*least, *most);
  const UpdateResult u = updated(known, {&a}, b, kAtOnce);
  const elements::TriangleMesh& now = u.model.ground;
  EXPECT_EQ(now.range_sigma_m, before.range_sigma_m);
  EXPECT_EQ(now.roughness_m, before.roughness_m);
  ASSERT_EQ(now.roughness.size(), now.size());
  const std::vector<uint32_t> kept = kept_triangles(before, now);
  for (size_t k = 0; k < kept.size(); ++k) {
    EXPECT_EQ(now.roughness[k],
              kept[k] == kNewTriangle ? float(before.roughness_m) : before.roughness[kept[k]]);
  }
}

// Elements of a refined model are refined among their neighbours, which one fit moves, too.
TEST(Update, ARefinedModelIsAsLikelyAsOneFit) {
  const BeamLog a = drive(true, 1, 20000), b = drive(true, 2, 15000), test = drive(true, 3, 15000);
  const auto nll = [&](const elements::Model& model) {
    const trace::World world(model);
    metrics::ScoreOptions what;
    what.world = &world;
    what.cloud = false;
    MemorySource real(test), same(test);
    return metrics::score(real, same, what).all.nll_per_beam;
  };
  const double one = nll(fitted(joined(a, b)).model), first = nll(fitted(a).model);
  EXPECT_LT(one, first - 0.01);
  for (const double growth : {0.0, 0.25}) {
    const UpdateResult u = updated(fitted(a), {&a}, b, {growth, growth});
    EXPECT_GT(u.report.added, u.model.ellipsoids.size() / 2);
    EXPECT_NEAR(nll(u.model), one, 0.05);
    for (const elements::Ellipsoid& e : u.model.ellipsoids) EXPECT_GT(e.density_per_m, 0);
  }
}

// What earlier scans remember may have gone, so keyframes are those of the new scans.
TEST(Update, KeyframesAreThoseOfTheNewScans) {
  const BeamLog before = drive(true, 1, 60'000), after = drive(false, 2, 60'000);
  const FitResult first = fitted(before);
  ASSERT_TRUE(first.model.keyframes);
  const auto known = first.model.keyframes;
  const UpdateResult grown = updated(first, {&before}, after, kAtOnce);
  ASSERT_TRUE(grown.model.keyframes);
  ASSERT_FALSE(grown.model.keyframes->frames.empty());
  const auto returns_of_the_car = [](const elements::Model& model) {
    size_t n = 0;
    for (const elements::Keyframe& f : model.keyframes->frames) {
      for (const elements::KeyframePixel& p : f.pixels) {
        if (!p.is_hit()) continue;
        const Vec3 at = model.origin + f.origin + model.keyframes->point(p) - kCar;
        n += std::abs(at.x()) < 2 && std::abs(at.y()) < 1 && std::abs(at.z()) < 0.75;
      }
    }
    return n;
  };
  EXPECT_GT(returns_of_the_car(first.model), 100u);
  EXPECT_EQ(returns_of_the_car(grown.model), 0u);
  FitOptions without = small_tiles();
  without.keyframes.spacing_m = 0;
  const UpdateResult none =
      updated(fitted(before, without), {&before}, after, kAtOnce, 1 << 20, without);
  EXPECT_FALSE(none.model.keyframes);
}

TEST(Update, GivesTheSameBitsForAnyThreadsAndChunks) {
  const BeamLog a = drive(true, 1, 20000), b = drive(false, 2, 15000);
  set_threads(1);
  const UpdateResult one = updated(fitted(a), {&a}, b, {});
  set_threads(2);
  const UpdateResult two = updated(fitted(a), {&a}, b, {}, 777);
  set_threads(0);
  expect_same_ellipsoids(one.model, two.model);
  expect_same_ground(one.model.ground, two.model.ground);
  EXPECT_EQ(one.model.ground.range_sigma_m, two.model.ground.range_sigma_m);
  EXPECT_EQ(one.model.ground.roughness_m, two.model.ground.roughness_m);
  for (size_t t = 0; t < one.model.ground.size(); ++t) {
    EXPECT_EQ(one.model.ground.hit[t].misses, two.model.ground.hit[t].misses);
  }
}

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
  const FitResult known = fitted(a);
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
  const UpdateOptions how{0.4, 1};
  const FitResult known = fitted(a);
  const UpdateResult first = updated(known, {&a}, b, how);
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
  const UpdateResult second = updated(as_fit(first), {&a, &b}, c, how);
  EXPECT_GT(anew(second), 0.5);
}

TEST(Update, ACarThatHasGoneVanishesAndTheRestRemains) {
  const BeamLog with = drive(true, 1, 60000), without = drive(false, 2, 30000);
  for (const std::string fitter : {"hierarchical", "likelihood"}) {
    const FitOptions options = small_tiles(fitter);
    const FitResult known = fitted(with, options);
    ASSERT_GT(ellipsoids_of_car(known.model), 30u);
    ASSERT_GT(opacity_towards(known.model, kCar), 0.95);
    // A refined car leaves some rims that beams hardly met.
    const size_t rims = fitter == "likelihood" ? 12 : 20;
    const FitResult one = fitted(joined(with, without), options);
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
    const FitOptions options = small_tiles(fitter);
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

TEST(Update, ReflectancesOfNewElementsAreOfTheSameScale) {
  BeamLog a = drive(true, 1, 20000), b = drive(true, 2, 15000);
  for (BeamLog* log : {&a, &b}) {
    for (size_t i = 0; i < log->size(); ++i) log->intensity[i] = log->is_hit(i) ? 30 : 0;
  }
  const UpdateResult u = updated(fitted(a), {&a}, b, kAtOnce);
  ASSERT_TRUE(u.model.light.known());
  ASSERT_EQ(u.model.ground.light.size(), u.model.ground.size());
  double sum = 0;
  for (const auto& e : u.model.ellipsoids) sum += e.light.mean;
  EXPECT_NEAR(sum / double(u.model.ellipsoids.size()), 30, 6);
}

TEST(Update, BadInputIsRefused) {
  const BeamLog a = drive(true, 1, 8000);
  const FitResult known = fitted(a);
  BeamLog far = a;
  for (Vec3& o : far.origin) o.x() += 5000;
  EXPECT_THROW(updated(known, {&a}, far, {}), DataError);
  for (Vec3& o : far.origin) o.x() += 1e12;
  EXPECT_THROW(updated(known, {&a}, far, {}), DataError);
  BeamLog other = a;
  other.info.sensor = "velodyne-vlp16";
  EXPECT_THROW(updated(known, {&a}, other, {}), DataError);
  FitResult bare = known;
  bare.record = {};
  EXPECT_THROW(updated(bare, {&a}, a, {}), DataError);
  FitOptions options = small_tiles();
  options.fitter = "surface";
  EXPECT_THROW(updated(fitted(a, options), {&a}, a, {}), DataError);
  EXPECT_THROW(updated(known, {&a}, a, {-1, 0}), std::invalid_argument);
  EXPECT_THROW(updated(known, {}, a, {}), std::invalid_argument);
}

TEST(Update, ScansInAnotherFrameAreWarnedOf) {
  const BeamLog a = drive(true, 1, 8000);
  BeamLog raised = a;
  for (Vec3& o : raised.origin) o.z() += 7;
  const UpdateResult u = updated(fitted(a), {&a}, raised, {});
  ASSERT_EQ(u.report.warnings.size(), 1u);
  EXPECT_NE(u.report.warnings[0].find("frame"), std::string::npos);
}

}  // namespace
}  // namespace underbrush::fit
