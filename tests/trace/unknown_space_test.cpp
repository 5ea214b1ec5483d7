#include "underbrush/trace/unknown_space.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "maps.hpp"
#include "underbrush/core/rng.hpp"

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

TEST(UnknownSpace, GroundReturnsAShareOfTheBeamsThatComeToIt) {
  ObservedSpace space = space_of(0, 0);
  for (const double h : {-0.25, -0.75, -1.5, -3.0, 0.25}) {
    space.density_per_m[ObservedSpace::height_interval(h)].fill(4);
  }
  space.ground_returns.fill(0.6f);
  const elements::TriangleMesh ground = flat_ground();
  const UnknownSpace unknown(space, ground, kOrigin);
  const RangeLimits far{0, 60};
  const Ray steep = ray_from({-9.5, 0.5, 1.5}, {1, 0, -1});
  const Ray grazing = ray_from({-9.5, 0.5, 1.5}, {1, 0, -0.1});
  for (const Ray& ray : {steep, grazing}) {
    int ended = 0;
    double deepest = 0;
    constexpr int kRays = 20000;
    for (int k = 0; k < kRays; ++k) {
      const auto end = unknown.drawn_end(ray, mix64(uint64_t(k)), far);
      ended += end.has_value();
      if (end) deepest += (ray.at(*end) - kOrigin).z();
    }
    EXPECT_NEAR(double(ended) / kRays, 0.6, 0.012);
    // The fall counts, not the way: both end a quarter of a metre below 0.5 m in the mean.
    EXPECT_NEAR(deepest / ended, 0.25, 0.12);
    std::vector<Intersection> all;
    unknown.add_to(ray, far, {}, all);
    RangeMixture p;
    mix_ranges(all, 1, 0, p);
    EXPECT_NEAR(p.miss, 0.4, 5e-3);
  }
}

TEST(UnknownSpace, DrawnEndsAreThoseOfAWalkStepByStep) {
  ObservedSpace space = space_of(0.02f, 3);
  for (const double h : {-0.25, -0.75, 0.25}) {
    space.density_per_m[ObservedSpace::height_interval(h)].fill(2);
  }
  space.ground_returns.fill(0.7f);
  const elements::TriangleMesh ground = flat_ground();
  const UnknownSpace unknown(space, ground, kOrigin);
  const RangeLimits limits{0.3, 70};
  Stream random(51);
  size_t high = 0, low = 0;
  for (uint64_t k = 0; k < 20000; ++k) {
    const double x = 20 * random.normal(), y = 20 * random.normal(), slope = random.normal();
    const Ray ray = ray_from({x, y, 1.9}, {std::cos(double(k)), std::sin(double(k)), 0.1 * slope});
    std::optional<double> expected;
    bool is_low = false, is_lost = false;
    unknown.follow(ray, limits, [&](const UnknownSpace::Step& s) {
      if (s.is_low() && !is_low) {
        is_low = true;
        const double share = unknown.ground().share(s.at.x(), s.at.y());
        is_lost = drawn_in_cell(k, s.cell, 1) >= double(0.7f) * share;
      }
      if (s.is_low() && is_lost) return true;
      const double depth = (s.is_low() ? 2 : double(0.02f)) * s.way_m(s.to_m);
      const double free = -std::log1p(-drawn_in_cell(k, s.cell, 0));
      if (s.height_m < -1 || s.height_m > 4 || free >= depth) return true;
      expected = s.from_m + (s.to_m - s.from_m) * free / depth;
      (s.is_low() ? low : high) += 1;
      return false;
    });
    ASSERT_EQ(unknown.drawn_end(ray, k, limits), expected) << k;
  }
  EXPECT_GT(high, 1000u);
  EXPECT_GT(low, 1000u);
}

TEST(UnknownSpace, DrawnEndsAreThoseOfAllCellsOfAHillyPlace) {
  ObservedSpace space = space_with_holes(20, 0.01);
  space.density_per_m = space_of(0.05f, 3).density_per_m;
  for (const double h : {-0.25, -0.75, 0.25}) {
    space.density_per_m[ObservedSpace::height_interval(h)].fill(2);
  }
  space.ground_returns.fill(0.7f);
  elements::TriangleMesh mesh;
  for (int x = -90; x <= 90; x += 2) {
    for (int y = -90; y <= 60; y += 2) {
      mesh.vertices.emplace_back(float(x), float(y), float(3 * std::sin(0.07 * x + 0.05 * y)));
    }
  }
  const UnknownSpace unknown(space, mesh, kOrigin);
  const CrossedCells crossed(space);
  const RangeLimits limits{0.3, 150};
  Stream random(55);
  size_t high = 0, low = 0, lost = 0;
  for (uint64_t k = 0; k < 20000; ++k) {
    const Vec3 from(40 * random.normal(), 40 * random.normal(), 5.5);
    const Ray ray =
        ray_from(from, {std::cos(double(k)), std::sin(double(k)), 0.1 * random.normal()});
    std::optional<double> expected;
    bool is_low = false, is_lost = false;
    // Steps begin where the ray comes between the lowest ground and the highest matter.
    const double rise = ray.direction.z();
    const double bottom = (unknown.ground().lowest_m() - 3 - from.z()) / rise,
                 top = (unknown.ground().highest_m() + 4 - from.z()) / rise;
    const double begin = std::max(limits.min_m, std::min(bottom, top)),
                 end = std::min(limits.max_m, std::max(bottom, top));
    for (int step = 0; begin + step < end && !expected; ++step) {
      const double t = begin + step, to = std::min(t + 1, end);
      const Vec3 at = from + 0.5 * (t + to) * ray.direction;
      const Cell3 cell = cell_of(at, 1);
      const double height = at.z() - unknown.ground().at(at.x(), at.y());
      if (crossed.holds(cell) || height > 4) continue;
      const bool near = height < ObservedSpace::kGroundM;
      if (near && unknown.ground().is_known(at.x(), at.y())) continue;
      const uint64_t hash = CellHash()(cell);
      if (near && !is_low) {
        is_low = true;
        is_lost = drawn_in_cell(k, hash, 1) >= double(0.7f);
        lost += is_lost;
      }
      if ((near && is_lost) || height < -1) continue;
      const double depth = near ? 2 * (to - t) * std::max(0.01, -rise) : double(0.05f) * (to - t);
      const double free = -std::log1p(-drawn_in_cell(k, hash, 0));
      if (free < depth) expected = t + (to - t) * free / depth;
      if (expected) (near ? low : high) += 1;
    }
    const std::optional<double> drawn = unknown.drawn_end(ray, k, limits);
    ASSERT_EQ(drawn.has_value(), expected.has_value()) << k;
    if (drawn) {
      ASSERT_NEAR(*drawn, *expected, 1e-9) << k;
    }
  }
  EXPECT_GT(high, 1000u);
  EXPECT_GT(low, 300u);
  EXPECT_GT(lost, 100u);
}

TEST(UnknownSpace, ALimitWithinAStepShortensThatStepAlone) {
  for (const float density : {0.02f, 0.5f}) {  // draws come before and after the look-up of cells
    const ObservedSpace space = space_of(density, 0);
    const elements::TriangleMesh ground = flat_ground();
    const UnknownSpace unknown(space, ground, kOrigin);
    Stream random(52);
    size_t before = 0, within = 0, none = 0;
    for (uint64_t k = 0; k < 40000; ++k) {
      const Vec3 place(20 * random.normal(), 20 * random.normal(), 1.9);
      const Ray ray =
          ray_from(place, {std::cos(double(k)), std::sin(double(k)), 0.02 * random.uniform()});
      const double limit = random.uniform(1, density < 0.1f ? 60 : 6);
      const double step = 0.3 + std::floor((limit - 0.3) / space.cell_m) * space.cell_m;
      std::optional<double> expected = unknown.drawn_end(ray, k, {0.3, 70});
      if (expected && *expected < step) {
        ++before;
      } else {
        const Vec3 middle = place + 0.5 * (step + limit) * ray.direction;
        const uint64_t cell = CellHash()(cell_of(middle, space.cell_m));
        const double free = -std::log1p(-drawn_in_cell(k, cell, 0));
        expected.reset();
        if (free < double(density) * (limit - step)) expected = step + free / double(density);
        ++(expected ? within : none);
      }
      const std::optional<double> end = unknown.drawn_end(ray, k, {0.3, limit});
      ASSERT_EQ(end.has_value(), expected.has_value()) << k << " " << limit;
      if (end) {
        ASSERT_NEAR(*end, *expected, 1e-9) << k;
      }
    }
    EXPECT_GT(before, 10000u);
    EXPECT_GT(within, 50u);
    EXPECT_GT(none, 5000u);
  }
}

TEST(GroundHeights, OfARectangleHoldThoseOfItsPlaces) {
  elements::TriangleMesh mesh;
  Stream random(56);
  for (int k = 0; k < 200; ++k) {
    mesh.vertices.emplace_back(float(random.uniform(-60, 60)), float(random.uniform(-60, 60)),
                               float(random.normal()));
  }
  const GroundHeights heights(mesh, {});
  int known = 0;
  for (int k = 0; k < 2000; ++k) {
    const double x = random.uniform(-200, 200) / 4, y = random.uniform(-200, 200) / 4;
    const double length = random.uniform(0.1, 12), width = random.uniform(0.1, 12);
    const auto along_x = heights.along_x(x, length), along_y = heights.along_y(y, width);
    const auto [low, high] = heights.bounds(along_x, along_y);
    bool all_known = true;
    for (int i = 0; i <= 40; ++i) {
      for (int j = 0; j <= 40; ++j) {
        const double at_x = x + length * i / 40, at_y = y + width * j / 40;
        ASSERT_GE(heights.at(at_x, at_y), low - 1e-6);
        ASSERT_LE(heights.at(at_x, at_y), high + 1e-6);
        all_known = all_known && heights.is_known(at_x, at_y);
      }
    }
    ASSERT_TRUE(all_known || !heights.is_known(along_x, along_y)) << k;
    known += heights.is_known(along_x, along_y);
  }
  EXPECT_GT(known, 20);
}

TEST(UnknownSpace, GroundThatLosesBeamsGoesOnLosingThem) {
  ObservedSpace space = space_of(0, 0);
  for (const double h : {-0.25, -0.75, 0.25}) {
    space.density_per_m[ObservedSpace::height_interval(h)].fill(10);
  }
  elements::TriangleMesh ground;
  for (int x = -20; x <= 20; x += 2) {
    for (int y = -20; y <= 20; y += 2) ground.vertices.emplace_back(float(x), float(y), 0.0f);
  }
  for (int32_t y = -5; y < 5; ++y) space.lost.push_back({{7, y}, 1000});
  const GroundHeights heights(ground, {}, space.lost);
  EXPECT_NEAR(heights.share(10, 0), 1, 1e-6);
  EXPECT_LT(heights.share(30, 0), 0.01);
  EXPECT_LT(heights.share(60, 0), 0.05);  // beyond the squares where beams were lost
  EXPECT_GT(heights.share(-60, 0), 0.95);
  const UnknownSpace unknown(space, ground, kOrigin);
  int ended[2] = {};
  for (int k = 0; k < 1000; ++k) {
    const uint64_t key = mix64(uint64_t(k));
    ended[0] += unknown.drawn_end(ray_from({30, 0.5, 2}, -Vec3::UnitZ()), key, {0, 50}).has_value();
    ended[1] +=
        unknown.drawn_end(ray_from({-30, 0.5, 2}, -Vec3::UnitZ()), key, {0, 50}).has_value();
  }
  EXPECT_LT(ended[0], 20);
  EXPECT_GT(ended[1], 940);
}

TEST(UnknownSpace, BelowGroundThatIsKnownNothingIsMet) {
  ObservedSpace space = space_of(0.5f, 0);
  for (const double h : {-0.25, -0.75, -1.5, -3.0, 0.25}) {
    space.density_per_m[ObservedSpace::height_interval(h)].fill(10);
  }
  elements::TriangleMesh ground;
  for (int x = -20; x < 0; x += 2) {
    for (int y = -20; y <= 20; y += 2) ground.vertices.emplace_back(float(x), float(y), 0.0f);
  }
  const UnknownSpace unknown(space, ground, kOrigin);
  const RangeLimits far{0, 60};
  int ended[2] = {}, above = 0;
  for (int k = 0; k < 1000; ++k) {
    const uint64_t key = mix64(uint64_t(k));
    const auto at_known = unknown.drawn_end(ray_from({-9, 0.5, 0.4}, -Vec3::UnitZ()), key, far);
    const auto beyond = unknown.drawn_end(ray_from({9, 0.5, 0.4}, -Vec3::UnitZ()), key, far);
    ended[0] += at_known.has_value();
    ended[1] += beyond.has_value();
    above += unknown.drawn_end(ray_from({-9, 0.5, 1.5}, Vec3::UnitY()), key, {0, 8}).has_value();
  }
  EXPECT_EQ(ended[0], 0);
  EXPECT_GT(ended[1], 950);
  EXPECT_GT(above, 950);
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
