#include "underbrush/surface/surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::surface {
namespace {

struct Cloud {
  std::vector<Vec3f> points, to_sensor;
};

constexpr Area kAll{-50, -50, 50, 50}, kNear{-7, -7, 7, 7};
constexpr SurfaceOptions kCoarse{.cell_m = 0.3, .kernel_m = 0.6, .least_kernel_m = 0.6};

Cloud sphere(size_t n, double radius, double noise = 0) {
  Stream random(21);
  Cloud c;
  for (size_t i = 0; i < n; ++i) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    const Vec3 d = Vec3(x, y, z).normalized();
    c.points.push_back(((radius + noise * random.normal()) * d).cast<float>());
    c.to_sensor.push_back((d * 7).cast<float>());
  }
  return c;
}

/// Makes a patch of a plane, 12 m × 12 m, seen from above.
Cloud plane(size_t n, const Vec3f& normal, double noise = 0) {
  Stream random(22);
  const Vec3f u = normal.unitOrthogonal(), v = normal.cross(u);
  Cloud c;
  for (size_t i = 0; i < n; ++i) {
    const double a = random.uniform(-6, 6), b = random.uniform(-6, 6);
    c.points.push_back(float(a) * u + float(b) * v + float(noise * random.normal()) * normal);
    c.to_sensor.push_back(normal);
  }
  return c;
}

double area(const IsoMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3f& a = mesh.vertices[t[0]];
    sum += 0.5 * double((mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm());
  }
  return sum;
}

TEST(Surface, PlanesOfAnySlopeAreExactAndHaveNoHoles) {
  for (const Vec3f& n :
       {Vec3f(0, 0, 1), Vec3f(1, 0, 0), Vec3f(1, 2, 3), Vec3f(1, 1, 1), Vec3f(-3, 1, 0)}) {
    const Vec3f normal = n.normalized();
    const Cloud c = plane(40000, normal);
    const SurfaceTile tile = surface_tile(c.points, c.to_sensor, kAll, kCoarse);
    EXPECT_GT(area(tile.mesh), 135);  // of 144 m², with a trimmed border
    EXPECT_LT(area(tile.mesh), 12.8 * 12.8);
    for (const Vec3f& v : tile.mesh.vertices) ASSERT_NEAR(normal.dot(v), 0, 2e-5);
    for (const auto& t : tile.mesh.triangles) {
      const Vec3f& a = tile.mesh.vertices[t[0]];
      const Vec3f cross = (tile.mesh.vertices[t[1]] - a).cross(tile.mesh.vertices[t[2]] - a);
      ASSERT_GE(cross.dot(normal), -1e-6f);  // faces the sensor
    }
    EXPECT_LT(std::sqrt(tile.sum_squares_m2 / double(tile.points)), 1e-4);
    EXPECT_GT(tile.points, size_t(39000));
  }
}

TEST(Surface, SphereConverges) {
  double last = 0;
  for (double cell : {0.4, 0.2, 0.1}) {
    const Cloud c = sphere(200000, 2);
    const SurfaceOptions o{.cell_m = cell, .kernel_m = 1.4 * cell};
    const SurfaceTile tile = surface_tile(c.points, c.to_sensor, {-3, -3, 3, 3}, o);
    std::map<std::array<uint32_t, 2>, int> sides;
    double volume = 0;
    for (const auto& t : tile.mesh.triangles) {
      const auto& v = tile.mesh.vertices;
      volume += double(v[t[0]].dot(v[t[1]].cross(v[t[2]]))) / 6;
      for (size_t k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
    }
    for (const auto& [side, n] : sides) ASSERT_TRUE(n == 1 && sides.count({side[1], side[0]}));
    const double error = std::max(std::abs(area(tile.mesh) / (16 * std::numbers::pi) - 1),
                                  std::abs(volume / (32 / 3.0 * std::numbers::pi) - 1));
    if (last > 0) {
      EXPECT_LT(error, last / 2.5);
    }
    last = error;
  }
  EXPECT_LT(last, 0.005);
}

TEST(Surface, SigmaIsTheNoise) {
  const Cloud c = plane(60000, Vec3f(1, 2, 5).normalized(), 0.03);
  const SurfaceTile tile = surface_tile(c.points, c.to_sensor, kAll, kCoarse);
  EXPECT_NEAR(std::sqrt(tile.sum_squares_m2 / double(tile.points)), 0.03, 0.002);
}

TEST(Surface, EndsWhereThePointsEnd) {
  Cloud c = plane(40000, Vec3f(0, 0, 1));
  std::erase_if(c.points, [](const Vec3f& p) { return p.head<2>().norm() < 2; });
  c.to_sensor.resize(c.points.size());
  const SurfaceTile tile = surface_tile(c.points, c.to_sensor, kNear);
  for (const Vec3f& v : tile.mesh.vertices) {
    EXPECT_GT(v.head<2>().norm(), 1.85f);
    EXPECT_LT(v.cwiseAbs().maxCoeff(), 6.1f);
  }
  // An isolated pair of points makes no surface.
  c.points = {{0, 0, 0}, {0.2f, 0, 0}};
  c.to_sensor.resize(2);
  EXPECT_TRUE(surface_tile(c.points, c.to_sensor, kNear).mesh.triangles.empty());
}

// A scanner sees one side of a pole 10 cm wide and 4 m high.
TEST(Surface, ThinThingsGetNoRim) {
  Cloud c;
  for (int i = 0; i <= 10; ++i) {
    for (int k = 0; k < 200; ++k) {
      c.points.push_back({0.01f * float(i), 0, 0.02f * float(k)});
      c.to_sensor.push_back({0, -1, 0});
    }
  }
  const SurfaceTile tile = surface_tile(c.points, c.to_sensor, kNear);
  EXPECT_GT(area(tile.mesh), 0.35);
  EXPECT_LT(area(tile.mesh), 4.2 * 0.25);
  for (const Vec3f& v : tile.mesh.vertices) EXPECT_NEAR(v.x(), 0.05, 0.13);
}

/// Makes rows of points 2 cm apart, with `spacing_m` between the rows, as on far ground.
Cloud rows(int n, float spacing_m) {
  Cloud c;
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < 200; ++k) {
      c.points.push_back({spacing_m * float(i), 0.02f * float(k), 0});
      c.to_sensor.push_back({-5, 0, 1});
    }
  }
  return c;
}

TEST(Surface, JoinsSparseRowsButNotFarOnes) {
  const Cloud near = rows(10, 0.4f), far = rows(10, 2);
  const double whole = 9 * 0.4 * 4,
               part = area(surface_tile(near.points, near.to_sensor, kNear).mesh);
  EXPECT_GT(part, 0.95 * whole);
  EXPECT_LT(part, 1.2 * whole);
  // A single row has no normal, so no triangle stands up there.
  EXPECT_TRUE(surface_tile(far.points, far.to_sensor, kNear).mesh.triangles.empty());
}

// The surface is a corner between two walls, with noise. The test compares the mean distance of the
// surface near the edge from the walls' planes.
TEST(Surface, RimlsKeepsTheEdgeOfABox) {
  Stream random(23);
  Cloud c;
  for (int i = 0; i < 40000; ++i) {
    const double along = random.uniform(-1, 1), across = random.uniform(0, 1);
    const double noise = 0.005 * random.normal();
    const bool side = i % 2;
    c.points.push_back(Vec3(side ? noise : across, along, side ? -across : noise).cast<float>());
    c.to_sensor.push_back(side ? Vec3f(-1, 0, 0) : Vec3f(0, 0, 1));
  }
  const auto error = [&](const SignedDistance& f) {
    const SurfaceOptions o{.cell_m = 0.05, .kernel_m = 0.2, .least_kernel_m = 0.2};
    const SurfaceTile tile = surface_tile(c.points, c.to_sensor, {-0.5, -0.5, 0.5, 0.5}, o, f);
    double sum = 0;
    int n = 0;
    for (const Vec3f& v : tile.mesh.vertices) {
      if (v.x() > 0.08f || v.z() < -0.08f) continue;
      sum += double(std::min(std::abs(v.x()), std::abs(v.z())));
      ++n;
    }
    EXPECT_GT(n, 60);
    return sum / n;
  };
  EXPECT_LT(error(rimls), error(imls) / 1.5);
}

TEST(Surface, TilesJoinToTheWholeInAnyOrderOfPoints) {
  Cloud c = sphere(30000, 3, 0.05);
  const Cloud flat = plane(30000, Vec3f(1, 0, 5).normalized(), 0.05);
  c.points.insert(c.points.end(), flat.points.begin(), flat.points.end());
  c.to_sensor.insert(c.to_sensor.end(), flat.to_sensor.begin(), flat.to_sensor.end());
  set_threads(1);
  const SurfaceTile whole = surface_tile(c.points, c.to_sensor, {-10, -10, 10, 10}, kCoarse);
  set_threads(0);
  const auto less = [](const Vec3f& a, const Vec3f& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  using Corners = std::array<Vec3f, 3>;
  std::vector<Corners> all, pieces;
  const auto append = [](const IsoMesh& m, std::vector<Corners>& to) {
    for (const auto& t : m.triangles) {
      to.push_back({m.vertices[t[0]], m.vertices[t[1]], m.vertices[t[2]]});
    }
  };
  append(whole.mesh, all);
  size_t points = 0;
  const double margin = surface_margin_m(kCoarse);
  for (const Area& core :
       {Area{-10, -10, 0.77, 10}, Area{0.77, -10, 10, 1}, Area{0.77, 1, 10, 10}}) {
    Cloud part;  // with its margin, in reverse order
    for (size_t i = c.points.size(); i-- > 0;) {
      const Vec3 p = c.points[i].cast<double>();
      if (p.x() < core.x0 - margin || p.x() > core.x1 + margin || p.y() < core.y0 - margin ||
          p.y() > core.y1 + margin) {
        continue;
      }
      part.points.push_back(c.points[i]);
      part.to_sensor.push_back(c.to_sensor[i]);
    }
    const SurfaceTile tile = surface_tile(part.points, part.to_sensor, core, kCoarse);
    append(tile.mesh, pieces);
    points += tile.points;
  }
  const auto order = [&](const Corners& a, const Corners& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), less);
  };
  std::sort(all.begin(), all.end(), order);
  std::sort(pieces.begin(), pieces.end(), order);
  EXPECT_GT(all.size(), 1000u);
  EXPECT_EQ(all, pieces);
  EXPECT_EQ(whole.points, points);
}

TEST(Surface, AnotherImplicitTakesItsPlace) {
  const Cloud c = plane(20000, Vec3f(0, 0, 1));
  const SurfaceTile tile =
      surface_tile(c.points, c.to_sensor, kAll, kCoarse,
                   [](const Vec3f& x, std::span<const OrientedPoint>) { return x.z() - 0.125f; });
  ASSERT_FALSE(tile.mesh.vertices.empty());
  for (const Vec3f& v : tile.mesh.vertices) EXPECT_NEAR(v.z(), 0.125, 1e-6);
}

TEST(Surface, DegenerateInput) {
  EXPECT_TRUE(surface_tile({}, {}, kAll).mesh.triangles.empty());
  const float nan = std::nanf("");
  const std::vector<Vec3f> bad{{nan, 0, 0}, {0, INFINITY, 0}}, same(100, Vec3f(1, 1, 1));
  EXPECT_TRUE(surface_tile(bad, bad, kAll).mesh.triangles.empty());
  EXPECT_TRUE(surface_tile(same, same, kAll).mesh.triangles.empty());
  EXPECT_TRUE(surface_tile(same, same, {5, 5, 5, 9}).mesh.triangles.empty());
  EXPECT_THROW(surface_tile(same, bad, kAll), std::invalid_argument);
  EXPECT_THROW(surface_tile(same, same, kAll, {.cell_m = 0}), std::invalid_argument);
  EXPECT_THROW(surface_tile(same, same, kAll, {.cell_m = 1e-4}), std::invalid_argument);
  const std::vector<Vec3f> tall{Vec3f(0, 0, 0), Vec3f(0, 0, 1e6)};
  EXPECT_THROW(surface_tile(tall, tall, kAll), DataError);
}

}  // namespace
}  // namespace underbrush::surface
