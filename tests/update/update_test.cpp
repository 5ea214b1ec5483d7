#include "underbrush/update/update.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/metrics/score.hpp"
#include "underbrush/update/kept_triangles.hpp"
#include "update_site.hpp"

namespace underbrush::update {
namespace {

TEST(Update, WithoutScansNothingChanges) {
  const BeamLog a = drive(true, 1, 20000), none = a.like();
  const fit::FitResult known = fitted(a);
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
    fit::FitOptions options = small_tiles();
    options.fitter = fitter;
    const fit::FitResult all = fitted(joined(a, b), options);
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
  const fit::FitOptions options = small_tiles("hierarchical");
  const auto added = [&](fit::FitResult known, const std::vector<const BeamLog*>& logs,
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

// The roughness of the ground is learnt again where all beams are at hand.
TEST(Update, TheGroundIsAsRoughAsInOneFit) {
  elements::Model truth = test::flat_ground(60);
  truth.ground.roughness_m = 0.05;
  truth.ground.roughness = {0.01f, 0.1f};
  const BeamLog a = test::drive_past(truth, 1, 20000, 3000, -0.4),
                b = test::drive_past(truth, 2, 20000, 3000, -0.4);
  const fit::FitResult known = fitted(a);
  const elements::TriangleMesh& before = known.model.ground;
  const elements::TriangleMesh one = fitted(joined(a, b)).model.ground;
  const elements::TriangleMesh now = updated(known, {&a}, b, kAtOnce).model.ground;
  EXPECT_EQ(now.range_sigma_m, before.range_sigma_m);
  EXPECT_EQ(now.roughness_m, before.roughness_m);
  ASSERT_EQ(now.roughness.size(), now.size());
  const std::vector<uint32_t> in_now = kept_triangles(now, one, HUGE_VALF),
                              in_before = kept_triangles(before, one, HUGE_VALF);
  double off = 0, off_before = 0;
  for (size_t k = 0; k < one.size(); ++k) {
    if (in_now[k] == kNewTriangle || in_before[k] == kNewTriangle) continue;
    const auto distance = [&](float roughness) {
      return one.hit[k].hits * std::abs(std::log(roughness / one.roughness[k]));
    };
    off += distance(now.roughness[in_now[k]]);
    off_before += distance(before.roughness[in_before[k]]);
  }
  EXPECT_LT(off, 0.7 * off_before);
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
  const fit::FitResult known = fitted(a);
  BeamLog far = a;
  for (Vec3& o : far.origin) o.x() += 5000;
  EXPECT_THROW(updated(known, {&a}, far, {}), DataError);
  for (Vec3& o : far.origin) o.x() += 1e12;
  EXPECT_THROW(updated(known, {&a}, far, {}), DataError);
  BeamLog other = a;
  other.info.sensor = "velodyne-vlp16";
  EXPECT_THROW(updated(known, {&a}, other, {}), DataError);
  fit::FitResult bare = known;
  bare.record = {};
  EXPECT_THROW(updated(bare, {&a}, a, {}), DataError);
  fit::FitOptions options = small_tiles();
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
}  // namespace underbrush::update
