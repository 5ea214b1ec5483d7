#include <gtest/gtest.h>

#include <algorithm>

#include "simulate/targets.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/simulate/draw.hpp"
#include "underbrush/simulate/probe_plane.hpp"
#include "underbrush/simulate/sub_ray_bundle.hpp"
#include "underbrush/simulate/sub_returns.hpp"

namespace underbrush::simulate {
namespace {

TEST(SubRayBundle, HasTheRaysOfTheRayMakerAndTheBeamsKeyFirst) {
  for (const sensor::Growth growth : {sensor::Growth::kCone, sensor::Growth::kWaist}) {
    sensor::BeamShape shape = sensor::round_beam(3e-3, 0.02);
    shape.divergence_rad[1] = 1e-3;
    shape.growth = growth;
    const sensor::RayMaker maker(shape);
    for (const int n : {1, 2, 3, 41}) {
      const auto places = sensor::spread_sub_rays(shape, n);
      const SubRayBundle bundle(shape, places);
      ASSERT_EQ(bundle.size(), size_t(n));
      Stream random(5);
      for (int beam = 0; beam < 50; ++beam) {
        Vec3 d;
        for (double& c : d) c = random.normal();
        const sensor::BeamAxes axes = sensor::beam_axes({Vec3(100, -7, 2), d.normalized()});
        std::vector<Ray> rays(bundle.size());
        bundle.spread(axes, rays.data());
        for (size_t k = 0; k < rays.size(); ++k) {
          const Ray want = maker.ray(axes, double(places[k].u), double(places[k].v));
          EXPECT_LT((rays[k].origin - want.origin).norm(), 1e-13);
          EXPECT_LT((rays[k].direction - want.direction).norm(), 1e-15);
        }
      }
      std::vector<uint64_t> keys(bundle.size());
      bundle.keys(77, keys.data());
      EXPECT_EQ(keys[0], 77u);
      std::sort(keys.begin(), keys.end());
      EXPECT_EQ(std::adjacent_find(keys.begin(), keys.end()), keys.end());
    }
  }
}

TEST(SubReturns, AreThoseThatMetSomethingAtTheRangesOfTheirDraws) {
  const trace::RangeLimits limits{1, 50};
  const QuickNormal normal;
  SubReturns returns(100);
  Stream random(9);
  for (int beam = 0; beam < 200; ++beam) {
    std::vector<trace::Intersection> met(100);
    std::vector<uint64_t> keys(met.size());
    std::vector<float> weight(met.size());
    for (size_t k = 0; k < met.size(); ++k) {
      keys[k] = random.bits();
      weight[k] = float(k);
      if (random.uniform() < 0.3) continue;
      met[k].element = uint32_t(random.below(1 << 20));
      met[k].t_m = random.uniform(1, 50);
      met[k].sigma_m = random.uniform() < 0.2 ? 0 : random.uniform(0, 5);
    }
    std::vector<float> range_m(met.size());
    std::vector<uint64_t> used = keys;
    draw_ranges(met, limits, used, range_m);
    returns.collect(range_m, weight);
    size_t n = 0;
    for (size_t k = 0; k < met.size(); ++k) {
      if (met[k].none()) continue;
      ASSERT_LT(n, returns.size());
      EXPECT_EQ(returns.sub_ray()[n], k);
      EXPECT_EQ(returns.weight()[n], weight[k]);
      const double slow = drawn_on_ray(met[k], keys[k], limits);
      if (slow > 1.01 && slow < 49.99) {  // at the limits, 2e-4 σ could decide
        EXPECT_NEAR(double(returns.range_m()[n]), slow, 3e-4 * met[k].sigma_m + 4e-6);
      }
      ++n;
    }
    EXPECT_EQ(returns.size(), n);
  }
}

// The closed form of a random plane n·x = h, met by the rays of a beam with an aperture.
TEST(ProbePlane, HasTheRangesOfAnyPlaneAndRefusesWhatIsNone) {
  constexpr size_t kProbes = 13;
  Stream random(3);
  for (const sensor::Growth growth : {sensor::Growth::kCone, sensor::Growth::kWaist}) {
    sensor::BeamShape shape = sensor::round_beam(0.02, 0.03);
    shape.growth = growth;
    std::vector<sensor::SubRay> places = sensor::grid_sub_rays(shape, 9, 9);
    for (size_t k = 0; k < kProbes; ++k) {
      std::swap(places[k], places[k + size_t(random.below(uint32_t(places.size() - k)))]);
    }
    const ProbePlane plane(shape, places, kProbes);
    const sensor::RayMaker maker(shape);
    const sensor::BeamAxes axes{{Vec3::Zero(), Vec3::UnitX()}, Vec3::UnitY(), Vec3::UnitZ(), {}};
    const trace::RangeLimits limits{0.5, 100};
    int horizons = 0;
    for (int i = 0; i < 300; ++i) {
      const double grazing = std::pow(10, random.uniform(-2.5, 0)), turn = random.uniform(0, 6.3);
      const double height = 40 * grazing;
      const Vec3 normal(grazing, std::cos(turn), std::sin(turn));
      std::vector<float> want;
      for (const sensor::SubRay& p : places) {
        const Ray ray = maker.ray(axes, double(p.u), double(p.v));
        const double slope = normal.dot(ray.direction);
        const double r = (height - normal.dot(ray.origin)) / slope;
        want.push_back(slope > 0 && r <= limits.max_m ? float(r) : NAN);
      }
      const std::span<const float> probes(want.data(), kProbes);
      const auto returned =
          std::count_if(probes.begin(), probes.end(), [](float r) { return !std::isnan(r); });
      std::vector<float> got(places.size());
      ASSERT_EQ(plane.fill(probes, 0.02, limits, got), returned >= 5);
      if (returned < 5) continue;
      horizons += returned < int(kProbes);
      for (size_t k = 0; k < got.size(); ++k) {
        if (double(want[k]) > 99.99 || double(got[k]) > 99.99) continue;  // at the limit
        ASSERT_EQ(std::isnan(got[k]), std::isnan(want[k]));
        if (std::isnan(want[k])) continue;
        EXPECT_NEAR(got[k], want[k], 1e-4f * want[k]);
      }
      std::vector<float> bent(probes.begin(), probes.end());
      const auto at = size_t(i) % kProbes;
      bent[at] = std::isnan(bent[at]) ? 50 : bent[at] + 0.3f;
      EXPECT_FALSE(plane.fill(bent, 0.02, limits, got));
    }
    EXPECT_GT(horizons, 10);
  }
}

TEST(ProbePlane, TakesOverWhatTheNearestProbeIsOffThePlane) {
  const auto shape = sensor::round_beam(0.02, 0);
  const auto places = sensor::spread_sub_rays(shape, 41);
  const ProbePlane plane(shape, places, 20);
  std::vector<float> rough(20), got(places.size());
  Stream random(4);
  for (float& r : rough) r = float(20 + 0.01 * random.normal());
  ASSERT_TRUE(plane.fill(rough, 0.1, {1, 50}, got));
  for (size_t k = 0; k < got.size(); ++k) {
    if (k < rough.size()) {
      EXPECT_EQ(plane.nearest()[k], k);
    }
    EXPECT_NEAR(got[k], rough[plane.nearest()[k]], k < rough.size() ? 1e-5f : 0.02f);
  }
}

/// Answers `n` beams across an edge: a wall 20 m away for y < 0, and one 30 m away.
struct Answered {
  BeamLog log;
  double rays = 0;  ///< Sub-rays traced for each beam.
};
Answered across_an_edge(bool all, size_t n) {
  elements::Model model;
  add_wall(model, 20, -20, 0);
  add_wall(model, 30, -20, 20);
  const trace::World world(model, trace::Isa::kBest, trace::Draws::kOnce);
  const DynamicWorld still(world);
  const Reflection reflection(all_of("white_target"), 905e-9);
  const Instrument instrument = quiet_instrument();
  EchoOptions options;
  options.all_sub_rays = all;
  Answered out{beams_along_x(n)};
  for (size_t i = 0; i < n; ++i) {
    const double y = 4 * (double(i) / double(n) - 0.5);
    out.log.direction[i] = Vec3(20, y, 0).normalized().cast<float>();
  }
  EchoMaker maker(still, reflection, instrument, options);
  maker.answer(0, out.log);
  out.rays = double(maker.rays()) / double(n);
  return out;
}

TEST(SubRayTracer, AFewSubRaysSpeakForAllButAtAnEdge) {
  constexpr size_t kBeams = 400;
  const Answered all = across_an_edge(true, kBeams), few = across_an_edge(false, kBeams);
  const double sub_rays = double(quiet_instrument().sub_rays.size());
  EXPECT_EQ(all.rays, sub_rays);
  // The beam is 0.4 m of the 4 m wide, so a tenth of the beams are on the edge.
  EXPECT_NEAR(few.rays, 13 + 0.1 * (sub_rays - 13), 2);
  BeamLog a = all.log, b = few.log;
  keep_first_echoes(a);
  keep_first_echoes(b);
  size_t unlike = 0;
  for (size_t i = 0; i < kBeams; ++i) {
    unlike += std::abs(a.range_m[i] - b.range_m[i]) > 1e-3f ||
              std::abs(a.intensity[i] / b.intensity[i] - 1) > 1e-3f;
  }
  EXPECT_LE(unlike, 2u);  // those of which a single sub-ray meets the other wall
}

// Beams that graze the ground are metres long, in which 13 sub-rays would be gaps.
TEST(SubRayTracer, OnSlantedSurfacesProbesGiveTheEchoesOfAllSubRays) {
  elements::Model model;
  add_wall(model, 20, -20, 20, 80 * M_PI / 180);
  const trace::World world(model, trace::Isa::kBest, trace::Draws::kOnce);
  const DynamicWorld still(world);
  const Reflection reflection(all_of("white_target"), 905e-9);
  const auto answer = [&](bool all, uint64_t& rays) {
    BeamLog log = beams_along_x(200);
    for (size_t i = 0; i < log.size(); ++i) {
      log.direction[i] =
          Vec3(20, 0.02 * (double(i) - 100), 0.01 * double(i % 20)).normalized().cast<float>();
    }
    EchoOptions options;
    options.all_sub_rays = all;
    EchoMaker maker(still, reflection, quiet_instrument(), options);
    maker.answer(0, log);
    rays = maker.rays();
    return log;
  };
  uint64_t rays = 0, all_rays = 0;
  const BeamLog few = answer(false, rays), all = answer(true, all_rays);
  EXPECT_EQ(rays, 13 * 200u);
  EXPECT_EQ(all_rays, quiet_instrument().sub_rays.size() * 200);
  ASSERT_EQ(few.size(), all.size());
  const auto &width = column<float>(few, kPulseWidthColumn),
             &want = column<float>(all, kPulseWidthColumn);
  for (size_t i = 0; i < few.size(); ++i) {
    EXPECT_GT(want[i], 1.5f);  // many pulses long
    EXPECT_NEAR(few.range_m[i], all.range_m[i], 2e-3f) << i;
    EXPECT_NEAR(width[i] / want[i], 1, 2e-3f) << i;
    EXPECT_NEAR(few.intensity[i] / all.intensity[i], 1, 5e-3f) << i;
  }
}

TEST(SubRayTracer, WhereSubRaysAreFewOrDrawAnewAllAreTraced) {
  elements::Model model;
  add_wall(model, 20);
  const Reflection reflection(all_of("white_target"), 905e-9);
  const auto rays_of = [&](trace::Draws draws, const Instrument& instrument) {
    const trace::World world(model, trace::Isa::kBest, draws);
    const DynamicWorld still(world);
    EchoMaker maker(still, reflection, instrument, {});
    BeamLog beams = beams_along_x(10);
    maker.answer(0, beams);
    return maker.rays() / 10;
  };
  const Instrument fine = quiet_instrument(), coarse = quiet_instrument(5, 5);
  EXPECT_EQ(rays_of(trace::Draws::kOnce, fine), 13u);
  EXPECT_EQ(rays_of(trace::Draws::kAnew, fine), fine.sub_rays.size());
  EXPECT_EQ(rays_of(trace::Draws::kOnce, coarse), coarse.sub_rays.size());
}

}  // namespace
}  // namespace underbrush::simulate
