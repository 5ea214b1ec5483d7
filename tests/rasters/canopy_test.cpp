#include "underbrush/rasters/canopy.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::rasters {
namespace {

elements::Model square(double z, double half, float p) {
  elements::Model m;
  m.fitter = "test";
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    m.surface.vertices.emplace_back(float(x * half), float(y * half), float(z));
  }
  m.surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  m.surface.hit = {{p, 0, 0}, {p, 0, 0}};
  return m;
}

/// Ground at the height 10 m, and leaves of hit probability p at 15.5 m and 13.25 m over a part.
elements::Scene stand(float p) {
  elements::Scene scene;
  scene.models.push_back(square(0, 4, 1));
  std::swap(scene.models[0].ground, scene.models[0].surface);
  scene.models.push_back(square(5.5, 2, p));
  scene.models.push_back(square(3.25, 2, p));
  for (uint32_t k = 0; k < 3; ++k) {
    elements::Instance& i = scene.instances.emplace_back();
    i.model = k;
    i.world_from_model.translation = Vec3(100, -50, 10);
  }
  return scene;
}

// Law: two layers of hit probability p let (1 − p)² pass, and the height is that of the layer at
// which half of the light is gone.
TEST(Canopy, TwoLayersHaveTheirHeightCoverAndGap) {
  for (const float p : {0.3F, 0.6F}) {
    const elements::Scene scene = stand(p);
    const trace::World world(scene);
    const Canopy c = canopy_of(scene, world);
    EXPECT_EQ(c.low, Vec3(96, -54, 10));
    EXPECT_EQ(c.size, (std::array<uint32_t, 3>{8, 8, 6}));
    const size_t inside = 3 + 8 * 4, outside = 0;
    EXPECT_NEAR(c.ground[inside], 10, 1e-5);
    const double cover = 1 - (1 - p) * (1 - p);
    EXPECT_NEAR(c.cover[inside], cover, 1e-6);
    EXPECT_EQ(c.cover[outside], 0);
    EXPECT_NEAR(c.height[inside], p > 0.5 ? 5.5 : 3.25, 1e-5);
    EXPECT_EQ(c.height[outside], 0);
    // A third of the rays of a voxel are vertical.
    const size_t layer = inside + size_t(64) * 5;
    EXPECT_NEAR(c.gap[layer], 1 - p / 3, 1e-6);
    EXPECT_NEAR(c.area_density[layer], -std::log(1 - p / 3) / 0.5, 1e-5);
    EXPECT_EQ(c.gap[inside + size_t(64) * 4], 1);
    EXPECT_EQ(c.area_density[inside + size_t(64) * 4], 0);
  }
}

TEST(Canopy, PlantsBelowTheCoverHeightAreNoCover) {
  const elements::Scene scene = stand(1);
  const trace::World world(scene);
  EXPECT_EQ(canopy_of(scene, world, {1, 2, 6}).cover[35], 0);
  EXPECT_EQ(canopy_of(scene, world, {1, 2, 4}).cover[35], 1);
}

TEST(Canopy, AModelWithoutGroundHasNoHeights) {
  elements::Scene scene;
  scene.models.push_back(square(0.5, 2, 0.5F));
  scene.models[0].origin = Vec3(0.5, 0.5, 7);
  const trace::World world(scene.models[0]);
  const Canopy c = canopy_of(scene, world, {0.5, 3, 2});
  EXPECT_TRUE(std::isnan(c.height.at(12)) && std::isnan(c.cover[12]) && std::isnan(c.ground[12]));
  EXPECT_EQ(c.low.x(), -1.5);
  EXPECT_NEAR(c.gap.at(2 + 4 * 9), 1 - 0.5 / 3, 1e-6);
}

TEST(Canopy, RefusesWhatIsOutOfRange) {
  const elements::Scene scene = stand(1);
  const trace::World world(scene);
  for (const CanopyOptions& o : {CanopyOptions{0, 4, 2}, {NAN, 4, 2}, {1, 0, 2}, {1, 101, 2}}) {
    EXPECT_THROW(canopy_of(scene, world, o), std::invalid_argument);
  }
  EXPECT_THROW(canopy_of(scene, world, {1e-4, 4, 2}), DataError);
  elements::Scene empty;
  empty.models.emplace_back();
  const trace::World nothing(empty.models[0]);
  EXPECT_THROW(canopy_of(empty, nothing), DataError);
}

}  // namespace
}  // namespace underbrush::rasters
