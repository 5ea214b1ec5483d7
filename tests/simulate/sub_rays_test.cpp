#include <gtest/gtest.h>

#include <algorithm>

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
    returns.collect(met, keys, weight, limits);
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

}  // namespace
}  // namespace underbrush::simulate
