#include "underbrush/surface/marching_cubes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::surface {
namespace {

template <class Field>
ScalarGrid sampled(int n, double cell_m, const Field& field) {
  ScalarGrid g{{-n / 2, -n / 2, -n / 2}, {n, n, n}, cell_m, {}};
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        g.value.push_back(float(field(g.place(0, i), g.place(1, j), g.place(2, k))));
      }
    }
  }
  return g;
}

/// Counts directed sides that are not matched by exactly one opposite side.
size_t open_sides(const IsoMesh& mesh) {
  std::map<std::array<uint32_t, 2>, int> sides;
  for (const auto& t : mesh.triangles) {
    for (size_t k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
  }
  size_t open = 0;
  for (const auto& [side, n] : sides) {
    const auto back = sides.find({side[1], side[0]});
    open += n != 1 || back == sides.end() || back->second != 1;
  }
  return open;
}

TEST(CubeTriangles, EachPatternUsesExactlyItsCrossedEdges) {
  for (int pattern = 0; pattern < 256; ++pattern) {
    std::array<int, 12> used{};
    for (const auto& t : cube_triangles()[size_t(pattern)]) {
      for (uint8_t e : t) used[e] = 1;
    }
    for (int e = 0; e < 12; ++e) {
      const auto [a, b] = cube_edge(e);
      EXPECT_EQ(used[size_t(e)], (pattern >> a & 1) != (pattern >> b & 1)) << pattern << " " << e;
    }
  }
  EXPECT_EQ(cube_triangles()[1].size(), 1u);
  EXPECT_EQ(cube_triangles()[0xf].size(), 2u);
  EXPECT_EQ(cube_triangles()[0x69].size(), 4u);  // four corners, none adjacent
}

TEST(MarchingCubes, SurfacesOfRandomFieldsAreClosedManifolds) {
  for (uint64_t seed : {1, 2, 3}) {  // White noise produces every pattern.
    Stream random(seed);
    constexpr int n = 24;
    ScalarGrid g{{0, 0, 0}, {n, n, n}, 0.1, {}};
    for (int k = 0; k < n * n * n; ++k) {
      const int x = k % n, y = k / n % n, z = k / n / n;
      const bool edge = x == 0 || y == 0 || z == 0 || x == n - 1 || y == n - 1 || z == n - 1;
      g.value.push_back(edge ? 1.0f : float(random.normal()));
    }
    const IsoMesh mesh = marching_cubes(g);
    EXPECT_GT(mesh.triangles.size(), 10000u);
    EXPECT_EQ(open_sides(mesh), 0u) << "seed " << seed;
  }
}

TEST(MarchingCubes, SphereConvergesAndPointsOutwards) {
  double last_area = 0, last_volume = 0;
  for (int n : {10, 20, 40}) {
    const IsoMesh mesh = marching_cubes(sampled(n, 3.0 / n, [](float x, float y, float z) {
      return std::sqrt(x * x + y * y + z * z) - 1;
    }));
    EXPECT_EQ(open_sides(mesh), 0u);
    double area = 0, volume = 0;
    for (const auto& t : mesh.triangles) {
      const Vec3f &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
      area += 0.5 * double((b - a).cross(c - a).norm());
      volume += double(a.dot(b.cross(c))) / 6;  // positive for outward faces
    }
    const double area_error = std::abs(area / (4 * std::numbers::pi) - 1);
    const double volume_error = std::abs(volume / (4 / 3.0 * std::numbers::pi) - 1);
    if (last_area > 0) {
      EXPECT_LT(area_error, last_area / 3);  // second-order convergence
      EXPECT_LT(volume_error, last_volume / 3);
    }
    last_area = area_error;
    last_volume = volume_error;
  }
  EXPECT_LT(last_volume, 0.01);
}

TEST(MarchingCubes, PlaneIsExactAndFacesPositiveValues) {
  const Vec3f normal = Vec3f(1, 2, 3).normalized();
  const IsoMesh mesh = marching_cubes(sampled(
      12, 0.3, [&](float x, float y, float z) { return normal.dot(Vec3f(x, y, z)) - 0.123f; }));
  ASSERT_GT(mesh.triangles.size(), 100u);
  for (const Vec3f& v : mesh.vertices) EXPECT_NEAR(normal.dot(v), 0.123, 1e-6);
  for (const auto& t : mesh.triangles) {
    const Vec3f& a = mesh.vertices[t[0]];
    EXPECT_GE((mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).dot(normal), 0);
  }
}

TEST(MarchingCubes, UnknownValuesLeaveHolesAndNothingElse) {
  ScalarGrid g = sampled(10, 1, [](float, float, float z) { return z - 0.25f; });
  g.value[g.at(5, 5, 5)] = NAN;
  const IsoMesh mesh = marching_cubes(g);
  EXPECT_EQ(mesh.triangles.size(), 2u * (81 - 4));
  EXPECT_EQ(mesh.vertices.size(), 100u - 1);
  EXPECT_TRUE(marching_cubes(ScalarGrid{{}, {0, 0, 0}, 1, {}}).triangles.empty());
  EXPECT_THROW(marching_cubes(ScalarGrid{{}, {2, 2, 2}, 1, {}}), std::invalid_argument);
}

TEST(MarchingCubes, TilesMeetBitForBitAndThreadsChangeNothing) {
  const auto field = [](float x, float y, float z) {
    return z - 0.3f * std::sin(3 * x) * std::cos(2 * y);
  };
  const ScalarGrid all = sampled(20, 0.17, field);
  ScalarGrid right = all;
  right.first[0] += 8;
  right.size[0] -= 8;
  right.value.clear();
  for (int k = 0; k < 20; ++k) {
    for (int j = 0; j < 20; ++j) {
      for (int i = 8; i < 20; ++i) right.value.push_back(all.value[all.at(i, j, k)]);
    }
  }
  set_threads(1);
  const IsoMesh whole = marching_cubes(all), part = marching_cubes(right);
  set_threads(0);
  EXPECT_EQ(marching_cubes(all).triangles, whole.triangles);
  EXPECT_EQ(marching_cubes(all).vertices, whole.vertices);
  const auto less = [](const Vec3f& a, const Vec3f& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  const std::map<Vec3f, int, decltype(less)> known = [&] {
    std::map<Vec3f, int, decltype(less)> m(less);
    for (const Vec3f& v : whole.vertices) m[v] = 1;
    return m;
  }();
  for (const Vec3f& v : part.vertices) EXPECT_TRUE(known.count(v));
}

}  // namespace
}  // namespace underbrush::surface
