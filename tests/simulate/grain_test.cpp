// Laws of matter that is drawn once: every single beam keeps its distribution over seeds, beams
// that pass within a grain meet the same matter, others do not, and sub-rays neither average a
// small footprint away nor change a large one's mean.
#include <gtest/gtest.h>

#include <cmath>

#include "simulate/targets.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::simulate {
namespace {

constexpr double kSigma = 0.3;  // m

/// Makes a world of one element 20 m away along x: an ellipsoid with the hit probability p, one of
/// path-length opacity, or a rough permeable wall.
enum class What { kEllipsoid, kPathLength, kWall };
elements::Model target(What what, float p, double grain_m, double noise_m = 0) {
  elements::Model model;
  model.tau = 3;
  model.grain.ellipsoid_m = model.grain.mesh_m = grain_m;
  model.range_noise_m = noise_m;
  if (what == What::kWall) {
    add_wall(model, 20, -100, 4000);
    for (auto& h : model.surface.hit) h.p = p;
    model.surface.range_sigma_m = kSigma;
    return model;
  }
  elements::Ellipsoid e;
  e.mean = Vec3f(20, 0, 0);
  e.set_covariance(Vec3(kSigma * kSigma, 1e8, 1e8).asDiagonal());
  e.hit.p = p;
  // With p = 1 − exp(−κ √(2π) σ) on the axis.
  if (what == What::kPathLength) {
    e.density_per_m = float(-std::log(1 - double(p)) / (std::sqrt(2 * M_PI) * kSigma));
  }
  model.ellipsoids.push_back(e);
  return model;
}

/// Makes beams along x whose origins lie `step_m` apart along y.
BeamLog row(size_t n, double step_m) {
  BeamLog log = beams_along_x(n);
  // No beam runs along an edge of the wall's triangles or a border of cells.
  for (size_t i = 0; i < n; ++i) log.origin[i] = Vec3(0, 0.0077 + step_m * double(i), 0.0061);
  return log;
}

BeamLog thin(const elements::Model& model, uint64_t seed, BeamLog beams) {
  const trace::World world(model, trace::Isa::kBest, trace::Draws::kOnce);
  Options options;
  options.seed = seed;
  simulate(world, options, 0, beams);
  return beams;
}

BeamLog echoes(const elements::Model& model, uint64_t seed, const Instrument& instrument,
               BeamLog beams) {
  const trace::World world(model, trace::Isa::kBest, trace::Draws::kOnce);
  const DynamicWorld dynamic_world(world);
  const Reflection reflection(all_of("white_target"), 905e-9);
  EchoOptions options;
  options.seed = seed;
  EchoMaker(dynamic_world, reflection, instrument, options).answer(0, beams);
  return beams;
}

struct Moments {
  double n = 0, hits = 0, sum = 0, square = 0;
  void add(float range_m) {
    ++n;
    if (range_m == kMiss) return;
    const double d = double(range_m) - 20;
    ++hits, sum += d, square += d * d;
  }
  double rate() const { return hits / n; }
  double mean() const { return sum / hits; }
  double sigma() const { return std::sqrt(square / hits - mean() * mean()); }
};

/// Expects the hit rate p and the ranges N(20, σ²) within five standard errors.
void expect_law(const Moments& m, double p, double sigma, const std::string& what) {
  EXPECT_NEAR(m.rate(), p, 5 * std::sqrt(p * (1 - p) / m.n)) << what;
  EXPECT_NEAR(m.mean(), 0, 5 * sigma / std::sqrt(m.hits)) << what;
  EXPECT_NEAR(m.sigma(), sigma, 5 * sigma / std::sqrt(2 * m.hits)) << what;
}

TEST(Grain, EverySingleBeamKeepsItsDistributionOverSeeds) {
  for (const What what : {What::kEllipsoid, What::kPathLength, What::kWall}) {
    for (const double noise_m : {0.0, 0.2}) {
      const elements::Model model = target(what, 0.3f, 0.1, noise_m);
      Moments m;
      for (uint64_t seed = 1; seed <= 4000; ++seed) {
        m.add(thin(model, seed, row(1, 0)).range_m[0]);
      }
      expect_law(m, 0.3, kSigma, std::to_string(int(what)));
    }
  }
}

TEST(Grain, OneWorldHasTheHitRateAndTheSpreadOverItsCells) {
  for (const What what : {What::kEllipsoid, What::kPathLength, What::kWall}) {
    Moments m;
    const BeamLog log = thin(target(what, 0.3f, 0.1), 7, row(6000, 0.5));
    for (const float range : log.range_m) m.add(range);
    expect_law(m, 0.3, kSigma, std::to_string(int(what)));
  }
}

TEST(Grain, BeamsWithinACellMeetTheSameMatterAndOthersDoNot) {
  const elements::Model model = target(What::kWall, 0.5f, 0.1);
  const BeamLog log = thin(model, 3, row(4000, 0.01));  // ten beams a cell
  size_t same = 0, changes = 0;
  for (size_t i = 1; i < log.size(); ++i) {
    if (log.range_m[i] == log.range_m[i - 1]) {
      ++same;
    } else {
      ++changes;
    }
  }
  // Of 399 borders of cells, 3/4 have a hit on one side or both; a cell's beams are all alike.
  EXPECT_NEAR(double(changes), 0.75 * 399, 5 * std::sqrt(399 * 0.75 * 0.25));
  EXPECT_EQ(same + changes, log.size() - 1);
  double product = 0, square = 0;
  const BeamLog far = thin(target(What::kWall, 1, 0.1), 3, row(4000, 0.25));
  for (size_t i = 1; i < far.size(); ++i) {
    product += (double(far.range_m[i]) - 20) * (double(far.range_m[i - 1]) - 20);
    square += std::pow(double(far.range_m[i]) - 20, 2);
  }
  EXPECT_NEAR(product / square, 0, 5 / std::sqrt(4000));
}

TEST(Grain, AClassCanHaveItsOwn) {
  // Beams 1 cm apart cross cells of 1 m; other classes have cells of 1 mm.
  for (const What what : {What::kEllipsoid, What::kPathLength}) {
    elements::Model model = target(what, 0.5f, 0.001);
    model.grain.classes = {{5, 0.3}, {7, 1}};
    const auto changes = [&](uint32_t label) {
      model.ellipsoids[0].label = label;
      const BeamLog log = thin(model, 3, row(4000, 0.01));
      size_t count = 0;
      for (size_t i = 1; i < log.size(); ++i) count += log.is_hit(i) != log.is_hit(i - 1);
      return double(count);
    };
    EXPECT_NEAR(changes(6), 0.5 * 3999, 5 * 0.5 * std::sqrt(3999));
    EXPECT_NEAR(changes(5), 0.5 * 133, 5 * 0.5 * std::sqrt(133));
    EXPECT_NEAR(changes(7), 0.5 * 40, 5 * 0.5 * std::sqrt(40));
  }
}

TEST(Grain, TheNoiseOfTheSensorIsDrawnAnewByEachBeam) {
  const elements::Model model = target(What::kWall, 1, 1, 0.05);
  BeamLog beams = row(4000, 0);
  double square = 0;
  const BeamLog log = thin(model, 5, beams);
  for (size_t i = 1; i < log.size(); ++i) {
    square += std::pow(double(log.range_m[i]) - double(log.range_m[i - 1]), 2);
  }
  EXPECT_NEAR(std::sqrt(square / double(2 * (log.size() - 1))), 0.05, 0.003);
}

TEST(Grain, ASmallFootprintHasTheRateAndTheSpreadOfTheThinRayForAnyNumberOfSubRays) {
  for (const What what : {What::kEllipsoid, What::kPathLength, What::kWall}) {
    const elements::Model model = target(what, 0.3f, 0.2);
    for (const int n : {1, 3, 6}) {
      Instrument instrument = quiet_instrument(n, n);
      instrument.beam = sensor::round_beam(1e-5, 0);  // 0.2 mm at 20 m
      instrument.sub_rays = sensor::grid_sub_rays(instrument.beam, n, n);
      Moments m;
      const BeamLog log = echoes(model, 1, instrument, row(6000, 0.5));  // each in its own cell
      for (const float range : log.range_m) m.add(range);
      expect_law(m, 0.3, kSigma, std::to_string(int(what)) + " " + std::to_string(n));
    }
  }
}

TEST(Grain, ALargeFootprintStopsTheShareOfTheLightThatTheHitProbabilitySays) {
  // 0.4 m at 20 m, of cells of 1 cm, before a white wall: the wall's echo has the light that is
  // left.
  elements::Model model = target(What::kEllipsoid, 0.3f, 0.01);
  add_wall(model, 25, -100, 4000);
  for (const int n : {16, 32}) {
    const BeamLog log = echoes(model, 11, quiet_instrument(n, n), row(200, 1));
    const BeamLog free = [&] {
      elements::Model wall;
      add_wall(wall, 25, -100, 4000);
      return echoes(wall, 11, quiet_instrument(n, n), row(1, 0));
    }();
    double left = 0;
    for (size_t i = 0; i < log.size(); ++i) {
      if (std::abs(log.range_m[i] - 25) < 0.05f) left += double(log.intensity[i]);
    }
    EXPECT_NEAR(left / 200 / double(free.intensity[0]), 0.7, 0.02) << n;
  }
}

TEST(Grain, MovesWithItsObjectAndStaysWhereTheWorldStandsStill) {
  elements::Scene scene;
  scene.models.push_back({});
  scene.models.push_back(target(What::kWall, 0.5f, 0.1));
  scene.instances.resize(2);
  scene.instances[1].model = 1;
  Trajectory path({{0, {}}, {1, {Eigen::Quaterniond::Identity(), Vec3(0, 3.03, 0)}}});
  const DynamicWorld world(scene, {{1, path}}, trace::Draws::kOnce);
  BeamLog before = row(500, 0.02), after = before, stayed = before;
  for (size_t i = 0; i < after.size(); ++i) {
    after.time_s[i] = stayed.time_s[i] = 1;
    after.origin[i].y() += 3.03;
  }
  for (BeamLog* log : {&before, &after, &stayed}) simulate(world, {}, 0, *log);
  size_t same = 0;
  for (size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(before.range_m[i] == kMiss, after.range_m[i] == kMiss) << i;
    same += (before.range_m[i] == kMiss) == (stayed.range_m[i] == kMiss);
  }
  EXPECT_NEAR(double(same), 250, 90);
}

TEST(Grain, NeitherThreadsNorChunksChangeTheMatter) {
  const elements::Model model = target(What::kWall, 0.5f, 0.05);
  const trace::World world(model, trace::Isa::kBest, trace::Draws::kOnce);
  set_threads(1);
  BeamLog one = row(20000, 0.003);
  simulate(world, {}, 0, one);
  set_threads(0);
  BeamLog all = row(20000, 0.003);
  simulate(world, {}, 0, all);
  EXPECT_EQ(one.range_m, all.range_m);
  for (size_t i = 0; i < all.size(); i += 997) {
    BeamLog alone = row(1, 0);
    alone.origin[0] = all.origin[i];
    simulate(world, {}, i, alone);
    EXPECT_EQ(alone.range_m[0], all.range_m[i]) << i;
  }
}

}  // namespace
}  // namespace underbrush::simulate
