#include "underbrush/fit/update.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/fit/kept_triangles.hpp"
#include "underbrush/metrics/score.hpp"
#include "update_site.hpp"

namespace underbrush::fit {
namespace {

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
