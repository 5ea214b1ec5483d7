// Tests of worlds of many triangles: pairs of neighbours, and permeable triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "scenes.hpp"
#include "underbrush/trace/triangle_pairs.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::trace {
namespace {

/// Makes flat kites of two triangles in all directions, some of which stand alone, have a corner
/// twice, or have a third triangle at an edge. Corners are in any order, and some are permeable.
elements::Model foliage(uint64_t seed, size_t leaves) {
  Stream random(seed);
  elements::Model model;
  elements::TriangleMesh& mesh = model.surface;
  for (size_t i = 0; i < leaves; ++i) {
    Vec3 foot, axis, side;
    for (int k = 0; k < 3; ++k) {
      foot[k] = random.uniform(-3, 3);
      axis[k] = random.normal();
      side[k] = random.normal();
    }
    const uint32_t at = uint32_t(mesh.vertices.size());
    const double size = random.uniform(0.02, 0.3);
    for (const Vec3& v : {foot, Vec3(foot + 0.5 * size * (axis + side)), Vec3(foot + size * axis),
                          Vec3(foot + 0.5 * size * (axis - side))}) {
      mesh.vertices.push_back(v.cast<float>());
    }
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
      std::array<uint32_t, 3> corners{at + a, at + b, at + c};
      std::rotate(corners.begin(), corners.begin() + long(random.below(3)), corners.end());
      mesh.triangles.push_back(corners);
      mesh.hit.push_back({float(random.below(2) ? 1 : random.uniform())});
    };
    const uint64_t kind = random.below(12);
    add(0, 1, 2);
    if (kind > 0) add(0, kind == 1 ? 0 : 2, 3);
    if (kind == 2) add(2, 0, 1);
    if (kind == 3) add(0, 3, 2);
  }
  mesh.range_sigma_m = 0.02;
  mesh.roughness_m = 0.01;
  model.check();
  return model;
}

TEST(TrianglePairs, HaveEveryTriangleOnceAndShareAnEdge) {
  const elements::Model model = foliage(3, 4000);
  const TrianglePairs pairs(model);
  std::vector<int> count(model.size());
  size_t both = 0;
  for (const uint32_t first : pairs.first()) {
    ++count[first];
    const TrianglePair& pair = pairs[first];
    if (pair.other == Intersection::kNone) continue;
    ++count[pair.other];
    ++both;
    const auto &a = model.surface.triangles[first], &b = model.surface.triangles[pair.other];
    EXPECT_EQ(a[(pair.apart + 1) % 3], b[(pair.other_apart + 2) % 3]);
    EXPECT_EQ(a[(pair.apart + 2) % 3], b[(pair.other_apart + 1) % 3]);
  }
  EXPECT_EQ(std::count(count.begin(), count.end(), 1), long(count.size()));
  EXPECT_GT(both, 3000u);
}

bool machine_has(Isa isa) {
  const elements::Model nothing;
  try {
    const World world(nothing, isa);
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

class Triangles : public testing::TestWithParam<Isa> {};

/// Seconds for the pairs of a mesh.
double seconds_of(const elements::Model& model) {
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_FALSE(TrianglePairs(model).first().empty());
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// A fan around one corner and many triangles at one place, which face both ways.
TEST(TrianglePairs, OfManyTrianglesAtACornerTakeLittleTime) {
  constexpr uint32_t kMany = 300000;
  elements::Model fan, same;
  fan.surface.vertices.emplace_back(0, 0, 0);
  same.surface.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (uint32_t k = 0; k < kMany; ++k) {
    const double angle = 2 * M_PI * k / kMany;
    fan.surface.vertices.emplace_back(float(std::cos(angle)), float(std::sin(angle)), 0);
    fan.surface.triangles.push_back({0, k + 1, (k + 1) % kMany + 1});
    same.surface.triangles.push_back({0, 1 + k % 2, 2 - k % 2});
  }
  fan.surface.hit.resize(kMany), same.surface.hit.resize(kMany);
  EXPECT_LT(TrianglePairs(fan).first().size(), kMany * 9 / 10);
  EXPECT_LT(seconds_of(fan), 5);
  EXPECT_LT(seconds_of(same), 5);
}

TEST_P(Triangles, OfFoliageAreMetAsBruteForceInDoubleMeetsThem) {
  if (!machine_has(GetParam())) GTEST_SKIP();
  const elements::Model model = foliage(5, 1500);
  const RangeLimits limits{0.5, 12};
  Stream random(6);
  size_t met_any = 0;
  for (const double spread : {0.02, 0.3, 3.0}) {  // from narrow bundles to rays one by one
    std::vector<Ray> rays;
    std::vector<uint64_t> keys;
    while (rays.size() < 4096) {
      Vec3 origin, axis;
      for (int k = 0; k < 3; ++k) {
        origin[k] = random.uniform(-6, 6);
        axis[k] = random.uniform(-2, 2);
      }
      for (int i = 0; i < 256; ++i) {
        Vec3 d = (axis - origin).normalized();
        for (int k = 0; k < 3; ++k) d[k] += spread * random.normal();
        rays.push_back({origin, d.normalized()});
        keys.push_back(beam_key(7, 0, rays.size()));
      }
    }
    const World world(model, GetParam());
    std::vector<Intersection> nearest(rays.size()), surface(rays.size());
    IntersectionLists all;
    world.nearest_accepted(rays, keys, limits, nearest);
    world.nearest_surface(rays, limits, surface);
    world.all_intersections(rays, limits, std::vector<double>(rays.size(), limits.max_m), all);
    for (size_t i = 0; i < rays.size(); ++i) {
      std::vector<Intersection> met;
      for (uint32_t e = 0; e < model.size(); ++e) {
        const Intersection m = intersect(model, e, rays[i].origin, rays[i].direction, limits);
        if (!m.none()) met.push_back(m);
      }
      std::sort(met.begin(), met.end(),
                [](const Intersection& a, const Intersection& b) { return a.before(b); });
      const auto first = std::find_if(met.begin(), met.end(),
                                      [&](const Intersection& m) { return accepts(keys[i], m); });
      const auto same = [](const Intersection& a, const Intersection& b) {
        return a.element == b.element && a.t_m == b.t_m && a.sigma_m == b.sigma_m && a.p == b.p;
      };
      ASSERT_TRUE(same(nearest[i], first == met.end() ? Intersection{} : *first)) << i;
      ASSERT_TRUE(same(surface[i], met.empty() ? Intersection{} : met.front())) << i;
      ASSERT_EQ(all[i].size(), met.size()) << i;
      ASSERT_TRUE(std::equal(met.begin(), met.end(), all[i].begin(), same)) << i;
      met_any += !met.empty();
    }
  }
  EXPECT_GT(met_any, 3000u);
}

// P(first = k) = p (1 − p)ᵏ must hold over the beams' keys behind k layers of the same p.
TEST_P(Triangles, ThatArePermeableStopTheirShareOfTheBeamsLayerByLayer) {
  if (!machine_has(GetParam())) GTEST_SKIP();
  constexpr double kP = 0.3;
  constexpr size_t kLayers = 4, kRays = 200000;
  elements::Model model;
  elements::TriangleMesh& mesh = model.surface;
  for (uint32_t k = 0; k < kLayers; ++k) {
    for (const auto& [y, z] : {std::pair{-9, -9}, {9, -9}, {9, 9}, {-9, 9}}) {
      mesh.vertices.emplace_back(float(10 + k), float(y), float(z));
    }
    mesh.triangles.push_back({4 * k, 4 * k + 1, 4 * k + 2});
    mesh.triangles.push_back({4 * k, 4 * k + 2, 4 * k + 3});
  }
  mesh.hit.assign(mesh.size(), {float(kP)});
  std::vector<Ray> rays(kRays);
  std::vector<uint64_t> keys(kRays);
  Stream random(8);
  for (size_t i = 0; i < kRays; ++i) {
    rays[i].direction = Vec3(1, random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)).normalized();
    keys[i] = beam_key(9, 0, i);
  }
  std::vector<Intersection> met(kRays);
  World(model, GetParam()).nearest_accepted(rays, keys, {0, 50}, met);
  std::vector<double> count(kLayers + 1);
  for (const Intersection& m : met) ++count[m.none() ? kLayers : m.element / 2];
  double through = 1;
  for (size_t k = 0; k <= kLayers; ++k) {
    const double share = through * (k < kLayers ? kP : 1);
    EXPECT_NEAR(count[k] / kRays, share, 5 * std::sqrt(share * (1 - share) / kRays)) << k;
    through *= 1 - kP;
  }
}

INSTANTIATE_TEST_SUITE_P(Trace, Triangles, testing::Values(Isa::kBase, Isa::kAvx2, Isa::kAvx512));

}  // namespace
}  // namespace underbrush::trace
