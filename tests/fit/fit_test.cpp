#include "underbrush/fit/fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "fit/two_bushes.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/fit/parameters.hpp"
#include "underbrush/simulate/simulate.hpp"

namespace underbrush::fit {
namespace {

double opacity_towards(const elements::Model& model, const Vec3& target, const Vec3& at) {
  const trace::World world(model);
  const Vec3 origin = at + Vec3(0, 0, 1.4);
  std::vector<trace::Intersection> met;
  world.all_intersections({origin, (target + at - origin).normalized()}, {0, 20}, 20, met);
  double through = 1;
  for (const auto& m : met) {
    if (model.kind(m.element) == elements::Kind::kEllipsoid) through *= 1 - model.hit(m.element).p;
  }
  return 1 - through;
}

TEST(Fit, HybridFindsGroundAndTellsThePermeableBushFromTheDenseOne) {
  const Vec3 at(5e5, 4e6, 200);
  const BeamLog log = test::drive_past_two_bushes(1, at);
  MemorySource source(log);
  FitOptions options;
  options.fitter = "hierarchical";
  options.credit.ellipsoid = {1, 1};
  const FitResult r = fit(source, options);
  EXPECT_EQ(r.report.beams, log.size());
  EXPECT_GT(r.model.ground.size(), 0u);
  EXPECT_NEAR(r.model.ground.range_sigma_m, 0.02, 0.02);
  for (const Vec3f& v : r.model.ground.vertices) {
    EXPECT_NEAR(v.z() + r.model.origin.z() - at.z(), 0, 0.3);
  }
  const double thin = opacity_towards(r.model, {0, -8, 1.2}, at);
  const double dense = opacity_towards(r.model, {0, 8, 1.2}, at);
  EXPECT_LT(thin, 0.8);
  EXPECT_GT(dense, thin + 0.1);
}

TEST(Fit, GivesTheSameBitsForAnyThreadsAndChunks) {
  const BeamLog log = test::drive_past_two_bushes(2, Vec3::Zero(), 15000);
  for (const std::string& fitter : fitter_names()) {
    FitOptions options;
    options.fitter = fitter;
    options.surface.cell_m = 0.2;
    options.tiles.tile_m = 12;
    set_threads(1);
    MemorySource one(log);
    const FitResult a = fit(one, options);
    set_threads(2);
    MemorySource parts(log, 777);
    const FitResult b = fit(parts, options);
    set_threads(0);
    EXPECT_EQ(a.model.ground.vertices, b.model.ground.vertices);
    EXPECT_EQ(a.model.ground.triangles, b.model.ground.triangles);
    EXPECT_EQ(a.model.surface.vertices, b.model.surface.vertices);
    EXPECT_EQ(a.model.surface.triangles, b.model.surface.triangles);
    ASSERT_EQ(a.model.size(), b.model.size());
    for (size_t i = 0; i < a.model.size(); ++i) {
      EXPECT_EQ(a.model.hit(i).p, b.model.hit(i).p);
      EXPECT_EQ(a.model.hit(i).misses, b.model.hit(i).misses);
    }
    for (size_t i = 0; i < a.model.ellipsoids.size(); ++i) {
      EXPECT_EQ(a.model.ellipsoids[i].mean, b.model.ellipsoids[i].mean);
      EXPECT_EQ(a.model.ellipsoids[i].covariance, b.model.ellipsoids[i].covariance);
    }
  }
}

// A log with marked returns in the air gives the elements of the log without them.
TEST(Fit, NothingIsMadeOfWhatIsMarkedAsMoving) {
  const BeamLog log = test::drive_past_two_bushes(4, Vec3::Zero(), 15000);
  BeamLog marked = log.like();
  Stream random(9);
  size_t added = 0;
  for (size_t i = 0; i < log.size(); ++i) {
    marked.append(log, i);
    if (i % 5) continue;
    marked.append(log, i);
    marked.range_m.back() = float(random.uniform(3, 6));
    marked.flags.back() |= kMover;
    ++added;
  }
  for (const std::string fitter : {"hierarchical", "surface", "likelihood"}) {
    FitOptions options;
    options.fitter = fitter;
    options.free_space_below = 0;
    MemorySource without(log), with(marked);
    const FitResult a = fit(without, options), b = fit(with, options);
    EXPECT_EQ(a.report.mover_points, 0u);
    if (fitter == "likelihood") {  // Its start sees the training scans alone.
      EXPECT_GT(b.report.mover_points, added / 2);
    } else {
      EXPECT_EQ(b.report.mover_points, added) << fitter;
    }
    EXPECT_EQ(a.model.ground.vertices, b.model.ground.vertices);
    EXPECT_EQ(a.model.surface.vertices, b.model.surface.vertices);
    ASSERT_EQ(a.model.ellipsoids.size(), b.model.ellipsoids.size());
    for (size_t i = 0; fitter != "likelihood" && i < a.model.ellipsoids.size(); ++i) {
      EXPECT_EQ(a.model.ellipsoids[i].mean, b.model.ellipsoids[i].mean);
      EXPECT_EQ(a.model.ellipsoids[i].hit.hits, b.model.ellipsoids[i].hit.hits);
      EXPECT_LE(a.model.ellipsoids[i].hit.misses, b.model.ellipsoids[i].hit.misses);
    }
  }
}

TEST(Fit, GroundMeshIsTheHybridWithoutItsEllipsoids) {
  const BeamLog log = test::drive_past_two_bushes(3, Vec3::Zero(), 15000);
  MemorySource source(log);
  FitOptions options;
  options.fitter = "hierarchical";
  const FitResult hybrid = fit(source, options);
  options.fitter = "ground_mesh";
  const FitResult bare = fit(source, options);
  EXPECT_EQ(bare.model.fitter, "ground_mesh");
  EXPECT_TRUE(bare.model.ellipsoids.empty());
  EXPECT_EQ(bare.model.surface.size(), 0u);
  EXPECT_GT(bare.model.ground.size(), 0u);
  EXPECT_EQ(bare.model.ground.vertices, hybrid.model.ground.vertices);
  EXPECT_EQ(bare.model.ground.triangles, hybrid.model.ground.triangles);
  // Some of the returns that ellipsoids explain are among the residuals of the bare ground.
  EXPECT_NEAR(bare.model.ground.range_sigma_m, hybrid.model.ground.range_sigma_m, 1e-3);
  EXPECT_EQ(bare.model.max_range_m, hybrid.model.max_range_m);
  EXPECT_EQ(bare.report.other_points, hybrid.report.other_points);
  size_t hits = 0;
  for (const auto& hit : bare.model.ground.hit) hits += hit.hits;
  EXPECT_GT(hits, bare.report.ground_points / 2);
}

// The same drive far from the origin gives the same model about its own origin.
TEST(Fit, MovesWithTheWorld) {
  const Vec3 far(5e5, 4e6, 200);
  const BeamLog near_log = test::drive_past_two_bushes(9, Vec3::Zero(), 12000);
  const BeamLog far_log = test::drive_past_two_bushes(9, far, 12000);
  for (const cluster::Clustering& clustering : cluster::clusterings()) {
    const std::string fitter(clustering.name);
    FitOptions options;
    options.fitter = fitter;
    MemorySource a(near_log), b(far_log);
    const elements::Model here = fit(a, options).model, there = fit(b, options).model;
    EXPECT_EQ(there.origin - here.origin, far);
    ASSERT_FALSE(here.ellipsoids.empty());
    size_t found = 0;
    for (const auto& e : here.ellipsoids) {
      found += std::any_of(there.ellipsoids.begin(), there.ellipsoids.end(), [&](const auto& o) {
        return (e.mean - o.mean).norm() < 1e-3f && std::abs(e.hit.p - o.hit.p) < 1e-3f;
      });
    }
    EXPECT_GT(double(found), 0.9 * double(here.ellipsoids.size())) << fitter;
  }
}

// Each return is fitted once, whatever the tiles, and the fitted elements explain the returns.
TEST(Fit, TilesDoubleNoPointAndEveryVolumetricFitterExplainsTheHits) {
  const BeamLog log = test::drive_past_two_bushes(7, Vec3::Zero(), 12000);
  for (const cluster::Clustering& clustering : cluster::clusterings()) {
    const std::string fitter(clustering.name);
    for (const double tile : {6.0, 32.0}) {
      FitOptions options;
      options.fitter = fitter;
      options.tiles.tile_m = tile;
      options.credit.max_residual_for_hit_m = 0.2;
      MemorySource source(log);
      const FitResult r = fit(source, options);
      EXPECT_EQ(r.report.ground_points + r.report.other_points, r.report.hits) << fitter;
      EXPECT_EQ(r.report.thinned_points, 0u);
      r.model.check();
      size_t credited = 0;
      for (size_t i = 0; i < r.model.size(); ++i) credited += r.model.hit(i).hits;
      EXPECT_GT(double(credited), 0.98 * double(r.report.hits)) << fitter << " " << tile;
      EXPECT_LE(credited, r.report.hits);
    }
  }
}

// The border of a tile cuts no voxel, so no two ellipsoids are in one cube.
TEST(Fit, VoxelsDoNotDependOnTheTiles) {
  const BeamLog log = test::drive_past_two_bushes(8, Vec3::Zero(), 20000);
  FitOptions options;
  options.fitter = "voxel";
  options.tiles.tile_m = 4;  // rounded to 13 voxels
  options.free_space_below = 0;
  MemorySource source(log);
  const FitResult r = fit(source, options);
  std::set<std::array<int, 3>> cubes;
  for (const auto& e : r.model.ellipsoids) {
    std::array<int, 3> cube;
    for (int d = 0; d < 3; ++d) cube[size_t(d)] = int(std::floor(e.mean[d] / 0.3));
    EXPECT_TRUE(cubes.insert(cube).second);
  }
  EXPECT_GT(cubes.size(), 100u);
}

// A cloud is there in one scan only, and all later beams pass through it.
TEST(Fit, DropsWhatOnlyOnceStoodInFreeSpace) {
  BeamLog log = test::drive_past_two_bushes(4);
  Stream random(5);
  for (size_t i = 0; i < log.size() / 20; ++i) {
    const Vec3f& d = log.direction[i];
    if (d.x() > 0.95f && d.z() > -0.15f) log.range_m[i] = float(4 + 0.1 * random.normal());
  }
  const auto ghosts = [&](double below) {
    FitOptions options;
    options.free_space_below = below;
    MemorySource source(log);
    const FitResult r = fit(source, options);
    size_t n = 0;
    for (const auto& e : r.model.ellipsoids) {
      const Vec3 at = r.model.origin + e.mean.cast<double>();
      n += (at - Vec3(-2, 0, 1.6)).norm() < 1.5;
    }
    return std::pair(n, r.report.free_space_ellipsoids);
  };
  EXPECT_GT(ghosts(0).first, 8u);
  EXPECT_EQ(ghosts(0).second, 0u);
  EXPECT_LT(ghosts(0.05).first, ghosts(0).first / 4);
  EXPECT_GT(ghosts(0.05).second, 0u);
}

/// Makes a log of a wall, a box on the ground before it and the ground, from a drive along them.
BeamLog drive_past_box(uint64_t seed) {
  elements::Model truth;
  truth.ground.vertices = {{-60, -60, 0}, {60, -60, 0}, {60, 60, 0}, {-60, 60, 0}};
  truth.ground.triangles = {{0, 1, 2}, {0, 2, 3}};
  truth.surface.vertices = {{-20, 7, 0}, {20, 7, 0}, {20, 7, 4}, {-20, 7, 4}, {-1, 5, 0},
                            {1, 5, 0},   {1, 5, 1},  {-1, 5, 1}, {-1, 7, 1},  {1, 7, 1}};
  truth.surface.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}, {7, 6, 9}, {7, 9, 8}};
  truth.ground.hit.resize(2);
  truth.surface.hit.resize(6);
  truth.ground.range_sigma_m = truth.surface.range_sigma_m = 0.01;
  BeamLog log;
  log.info.has_misses = true;
  Stream random(seed);
  log.resize(60000);
  for (size_t i = 0; i < log.size(); ++i) {
    const double azimuth = random.uniform(0.3, M_PI - 0.3), elevation = random.uniform(-0.5, 0.2);
    log.origin[i] = Vec3(-3 + 6 * double(i) / double(log.size()), 0, 1.8);
    log.direction[i] = Vec3(std::cos(azimuth) * std::cos(elevation),
                            std::sin(azimuth) * std::cos(elevation), std::sin(elevation))
                           .cast<float>();
  }
  const trace::World world(truth);
  simulate::simulate(world, {.seed = seed}, 0, log);
  return log;
}

/// Computes the share of ranges that differ by more than 0.1 m when the model answers half of the
/// beams of `log`.
double wrong_share(const FitResult& r, const BeamLog& log) {
  BeamLog answer = log;
  simulate::simulate(trace::World(r.model), {.seed = 9}, 0, answer);
  size_t wrong = 0, n = 0;
  for (size_t i = 0; i < log.size(); ++i) {
    if (!log.is_hit(i) || log.range_m[i] > 9) continue;
    wrong += !(std::abs(answer.range_m[i] - log.range_m[i]) < 0.1f);
    ++n;
  }
  return double(wrong) / double(n);
}

TEST(Fit, SurfacesAnswerNewBeamsOfWhatTheyWereFittedTo) {
  const BeamLog train = drive_past_box(7), test = drive_past_box(8);
  for (const char* fitter : {"surface", "rimls"}) {
    FitOptions options;
    options.fitter = fitter;
    options.surface.cell_m = 0.2;
    MemorySource source(train);
    EXPECT_LT(wrong_share(fit(source, options), test), 0.03) << fitter;
  }
}

TEST(Fit, TheNoiseOfASurfaceCanBeSet) {
  FitOptions options;
  options.fitter = "rimls";
  options.surface.cell_m = 0.3;
  options.surface.noise_m = 0.005;
  const BeamLog log = drive_past_box(7);
  MemorySource source(log);
  EXPECT_EQ(fit(source, options).model.surface.range_sigma_m, 0.005);
}

// The vehicle's own mast stands 1.5 m from the sensor and moves with it. An opaque model has a wall
// where the sensor comes later.
TEST(Fit, LeavesOutTheVehicleThatCarriesTheSensor) {
  BeamLog train = drive_past_box(7);
  const BeamLog test = drive_past_box(8);
  size_t own = 0;
  for (size_t i = 0; i < train.size(); ++i) {
    if (train.direction[i].x() < 0.9f) continue;
    train.range_m[i] = 1.5f;
    ++own;
  }
  ASSERT_GT(own, 1000u);
  FitOptions options;
  options.fitter = "surface";
  options.surface.cell_m = 0.2;
  MemorySource source(train);
  const FitResult with = fit(source, options);
  options.min_range_m = 2;
  const FitResult without = fit(source, options);
  EXPECT_EQ(without.report.near_points, own);
  EXPECT_GT(wrong_share(with, test), 0.15);
  EXPECT_LT(wrong_share(without, test), 0.08);
}

// An object stood between the sensor and the wall for the first tenth of the log.
TEST(Fit, CarvingDropsWhatMoreBeamsPassedThanMet) {
  BeamLog train = drive_past_box(7);
  const BeamLog test = drive_past_box(8);
  for (size_t i = 0; i < train.size() / 10; ++i) {
    const Vec3 d = train.direction[i].cast<double>();
    const double range = (3 - train.origin[i].y()) / d.y();
    const Vec3 p = train.origin[i] + range * d;
    if (std::abs(p.x()) < 1.5 && p.z() > 0.2) train.range_m[i] = float(range);
  }
  FitOptions options;
  options.fitter = "surface";
  options.surface.cell_m = 0.2;
  MemorySource source(train);
  const FitResult plain = fit(source, options);
  options.surface.carve = true;
  const FitResult carved = fit(source, options);
  EXPECT_EQ(plain.report.carved_triangles, 0u);
  EXPECT_EQ(plain.model.surface.size(),
            carved.model.surface.size() + carved.report.carved_triangles);
  EXPECT_GT(wrong_share(plain, test), 0.15);
  EXPECT_LT(wrong_share(carved, test), 0.04);
}

/// The drive past two bushes, where one in `one_in` of the returns beyond 9 m is found.
elements::Model learnt_with_few_far_returns(size_t one_in) {
  BeamLog log = test::drive_past_two_bushes(6);
  for (size_t i = 0; i < log.size(); ++i) {
    const bool far = log.is_hit(i) && log.range_m[i] > 9;
    if (far && (one_in == 0 || i % one_in != 0)) log.range_m[i] = kMiss;
  }
  MemorySource source(log);
  return fit(source, {}).model;
}

TEST(Fit, LearnsWhereTheSensorEnds) {
  const elements::Model cut = learnt_with_few_far_returns(0);
  EXPECT_LE(cut.max_range_m, 9);
  EXPECT_GT(cut.max_range_m, 8.9);
  LogInfo own, other;
  other.sensor = "velodyne-vlp16";
  EXPECT_EQ(cut.reach_of(own), cut.max_range_m);
  EXPECT_TRUE(std::isinf(cut.reach_of(other)));
  // Ranges that thin out tell what stands there, and not how far the sensor reaches.
  EXPECT_TRUE(std::isinf(learnt_with_few_far_returns(400).max_range_m));
}

TEST(Fit, SaysWhatALogLacks) {
  BeamLog log = test::drive_past_two_bushes(3);
  log.info.has_misses = false;
  MemorySource source(log);
  FitOptions options;
  EXPECT_EQ(fit(source, options).report.warnings.size(), 1u);
  options.volumetric.mixture.footprint = [](double) { return std::array<double, 2>{0.01, 0.01}; };
  EXPECT_EQ(fit(source, options).report.warnings.size(), 1u);
  options.fitter = "voxel";
  EXPECT_EQ(fit(source, options).report.warnings.size(), 2u);
  BeamLog empty;
  MemorySource nothing(empty);
  EXPECT_THROW(fit(nothing, {}), DataError);
  BeamLog misses;
  misses.resize(100);
  MemorySource only_misses(misses);
  EXPECT_THROW(fit(only_misses, {}), DataError);
  MemorySource again(log);
  options.min_range_m = -3;
  EXPECT_THROW(fit(again, options), std::invalid_argument);
  options.min_range_m = 0;
  options.fitter = "magic";
  EXPECT_THROW(fit(again, options), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::fit
