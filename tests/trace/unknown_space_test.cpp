#include "underbrush/trace/unknown_space.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace underbrush::trace {
namespace {

using elements::ObservedBlock;
using elements::ObservedSpace;

const Vec3 kOrigin(4e5, 5e6, 100);

/// A flat ground at z = 0 of the model.
elements::TriangleMesh flat_ground() {
  elements::TriangleMesh mesh;
  mesh.vertices = {{-20, -20, 0}, {20, -20, 0}, {20, 20, 0}, {-20, 20, 0}};
  return mesh;
}

/// Space of one density from 0 to 4 m above the ground, which n beams crossed for x in [0, 8).
ObservedSpace space_of(float density_per_m, uint8_t n) {
  ObservedSpace space;
  for (const double h : {0.25, 0.75, 1.5, 3.0}) {
    space.density_per_m[ObservedSpace::height_interval(h)].fill(density_per_m);
  }
  ObservedBlock block;
  block.beams.fill(n);
  space.blocks = {block};
  return space;
}

Ray ray_from(const Vec3& place, const Vec3& direction) {
  return {kOrigin + place, direction.normalized()};
}

TEST(UnknownSpace, RaysEndAsInAMediumOfItsDensity) {
  const ObservedSpace space = space_of(0.1f, 0);
  const elements::TriangleMesh ground = flat_ground();
  const UnknownSpace unknown(space, ground, kOrigin);
  const Ray ray = ray_from({-9.5, 0.5, 1.5}, Vec3::UnitX());
  int ended = 0, near = 0;
  constexpr int kRays = 20000;
  for (int k = 0; k < kRays; ++k) {
    const auto end = unknown.drawn_end(ray, mix64(uint64_t(k)), {0, 15});
    ended += end.has_value();
    near += end && *end < 5;
  }
  EXPECT_NEAR(double(ended) / kRays, 1 - std::exp(-1.5), 0.012);
  EXPECT_NEAR(double(near) / kRays, 1 - std::exp(-0.5), 0.012);
  // The mixture has the same distribution.
  std::vector<Intersection> all;
  unknown.add_to(ray, {0, 15}, {}, all);
  RangeMixture p;
  mix_ranges(all, 1, 0, p);
  EXPECT_NEAR(p.miss, std::exp(-1.5), 1e-3);
  EXPECT_NEAR(support_of(all, p), std::exp(-1.5), 1e-3);
  double before = 0;
  for (const auto& c : p.components) before += c.t_m < 5 ? c.weight : 0;
  EXPECT_NEAR(before, 1 - std::exp(-0.5), 0.06);
}

TEST(UnknownSpace, CrossedCellsAreKnown) {
  const elements::TriangleMesh ground = flat_ground();
  for (const uint8_t n : {0, 1, 255}) {
    const ObservedSpace space = space_of(0.2f, n);
    const UnknownSpace unknown(space, ground, kOrigin);
    std::vector<Intersection> all;
    unknown.add_to(ray_from({0, 0.5, 1.5}, Vec3::UnitX()), {0, 8}, {}, all);
    RangeMixture p;
    mix_ranges(all, 1, 0, p);
    EXPECT_NEAR(p.miss, n == 0 ? std::exp(-1.6) : 1, 1e-3) << int(n);
  }
}

TEST(UnknownSpace, HeightsAreThoseAboveTheGroundAlsoBeyondIt) {
  const ObservedSpace space = space_of(10, 0);
  const elements::TriangleMesh ground = flat_ground();
  const UnknownSpace unknown(space, ground, kOrigin);
  const RangeLimits far{0, 100};
  EXPECT_FALSE(unknown.drawn_end(ray_from({-10, 0, 5}, Vec3::UnitX()), 1, far));
  EXPECT_FALSE(unknown.drawn_end(ray_from({-10, 0, 5}, {1, 0, 0.1}), 1, far));
  const auto down = unknown.drawn_end(ray_from({40, 0, 6}, -Vec3::UnitZ()), 1, far);
  ASSERT_TRUE(down);
  EXPECT_NEAR(*down, 2.3, 0.8);
  EXPECT_FALSE(unknown.drawn_end(ray_from({-10, 0, -3}, -Vec3::UnitZ()), 1, far));
}

TEST(UnknownSpace, ElementsStayInOrderAndEndTheWay) {
  const ObservedSpace space = space_of(0.05f, 0);
  const elements::TriangleMesh ground = flat_ground();
  const UnknownSpace unknown(space, ground, kOrigin);
  Intersection thin, wall;
  thin.t_m = 3, thin.p = 0.5, thin.element = 7;
  wall.t_m = 9, wall.p = 1, wall.element = 8;
  std::vector<Intersection> all;
  unknown.add_to(ray_from({-9.5, 0.5, 1.5}, Vec3::UnitX()), {0, 60}, std::vector{thin, wall}, all);
  ASSERT_GE(all.size(), 4u);
  size_t elements = 0;
  for (size_t k = 0; k < all.size(); ++k) {
    EXPECT_LE(all[k == 0 ? 0 : k - 1].t_m, all[k].t_m);
    elements += all[k].element != kUnknown;
  }
  EXPECT_EQ(elements, 2u);
  EXPECT_EQ(all.back().element, 8u);
}

TEST(UnknownSpace, WithoutGroundAllIsKnown) {
  const ObservedSpace space = space_of(10, 0);
  const elements::TriangleMesh none;
  const UnknownSpace unknown(space, none, kOrigin);
  EXPECT_FALSE(unknown.drawn_end(ray_from({0, 0, 1}, Vec3::UnitX()), 1, {0, 100}));
}

}  // namespace
}  // namespace underbrush::trace
