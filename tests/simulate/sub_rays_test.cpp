#include <gtest/gtest.h>

#include <algorithm>

#include "simulate/targets.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/simulate/draw.hpp"
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
