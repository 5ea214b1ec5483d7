#include "underbrush/ground/triangulate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/ground/delaunay.hpp"

namespace underbrush::ground {
namespace {

using Points = std::vector<Eigen::Vector2d>;

double doubled_area(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// Checks that every triangle is counter-clockwise and that no point lies inside its circumcircle.
/// Gives the sum of the areas.
double checked_area(const Points& points, const std::vector<std::array<uint32_t, 3>>& triangles) {
  double sum = 0;
  for (const auto& t : triangles) {
    const Eigen::Vector2d &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
    const double area = doubled_area(a, b, c);
    EXPECT_GT(area, 0);
    sum += area / 2;
    for (const Eigen::Vector2d& p : points) {
      Mat3 in;
      in << (a - p).transpose(), (a - p).squaredNorm(), (b - p).transpose(), (b - p).squaredNorm(),
          (c - p).transpose(), (c - p).squaredNorm();
      EXPECT_LE(in.determinant(), 1e-9);
    }
  }
  return sum;
}

/// Gives the points and all triangles, those of the frame included.
std::pair<Points, std::vector<std::array<uint32_t, 3>>> all_of(const GridDelaunay& d) {
  Points points;
  std::vector<std::array<uint32_t, 3>> triangles;
  for (const auto& p : d.points()) points.emplace_back(p[0], p[1]);
  for (const auto& t : d.triangles()) triangles.push_back(t.point);
  return {points, triangles};
}

TEST(GridDelaunay, CircumcirclesAreEmptyAndTheFrameIsCovered) {
  for (uint64_t seed : {1, 2, 3}) {
    for (int side : {3, 12, 300}) {  // crowded (many on a circle or a line) to scattered
      Stream random(seed);
      GridDelaunay d(side);
      for (int k = 0; k < 250; ++k) {
        const int x = int(random.below(uint64_t(side) + 1)),
                  y = int(random.below(uint64_t(side) + 1));
        d.insert({x, y});
      }
      const auto [points, triangles] = all_of(d);
      EXPECT_EQ(checked_area(points, triangles), double(side + 2) * (side + 2));
      // Euler's formula with a hull of four points
      EXPECT_EQ(triangles.size(), 2 * points.size() - 6);
    }
  }
}

TEST(GridDelaunay, NeighboursShareASide) {
  Stream random(4);
  GridDelaunay d(40);
  for (int k = 0; k < 400; ++k) {
    const int x = int(random.below(41)), y = int(random.below(41));
    for (uint32_t t : d.insert({x, y})) {
      EXPECT_EQ(d.points()[d.triangles()[t].point[0]], (GridDelaunay::Point{x, y}));
    }
  }
  for (const auto& t : d.triangles()) {
    for (size_t k = 0; k < 3; ++k) {
      if (t.neighbour[k] < 0) continue;
      const auto& n = d.triangles()[size_t(t.neighbour[k])].point;
      EXPECT_EQ(std::count(n.begin(), n.end(), t.point[(k + 1) % 3]), 1);
      EXPECT_EQ(std::count(n.begin(), n.end(), t.point[(k + 2) % 3]), 1);
      EXPECT_EQ(std::count(n.begin(), n.end(), t.point[k]), 0);
    }
  }
}

TEST(GridDelaunay, DegeneratePoints) {
  GridDelaunay d(10);
  EXPECT_EQ(d.triangles().size(), 2u);
  d.insert({5, 5});
  EXPECT_TRUE(d.insert({5, 5}).empty());
  for (int x = 0; x <= 10; ++x) d.insert({x, 5});  // all on a line
  for (const auto& t : d.triangles()) EXPECT_FALSE(GridDelaunay::inner(t));
  EXPECT_THROW(d.insert({11, 0}), std::invalid_argument);
  EXPECT_THROW(GridDelaunay(0), std::invalid_argument);
}

/// Makes a height map of spacing 0.5 m with the nodes of [i0, i1] × [j0, j1] that `has` keeps.
template <class Has, class Height>
HeightMap map_of(int i0, int i1, int j0, int j1, const Has& has, const Height& height) {
  HeightMap map;
  map.spacing_m = 0.5;
  for (int j = j0; j <= j1; ++j) {
    for (int i = i0; i <= i1; ++i) {
      const auto key = block_of(i, j);
      const auto place = size_t(place_in_block(i, j));
      map.height.try_emplace(key).first->second[place] = height(0.5 * i, 0.5 * j);
      map.exists.try_emplace(key, std::array<uint8_t, kBlockNodes>{}).first->second[place] =
          has(i, j);
    }
  }
  return map;
}

struct Check {
  double area = 0, longest = 0;
  std::map<std::array<uint32_t, 2>, int> sides;  ///< Number of triangles at each directed side.
};

Check checked(const GroundMesh& mesh) {
  Check c;
  for (const auto& t : mesh.triangles) {
    Points p;
    for (uint32_t v : t) p.emplace_back(mesh.vertices[v].head<2>().cast<double>());
    const double area = doubled_area(p[0], p[1], p[2]);
    EXPECT_GT(area, 0);
    c.area += area / 2;
    for (size_t k = 0; k < 3; ++k) {
      c.longest = std::max(c.longest, (p[k] - p[(k + 1) % 3]).norm());
      ++c.sides[{t[k], t[(k + 1) % 3]}];
    }
  }
  return c;
}

/// Computes the area of the cells whose nodes exist, and the length of that area's edge.
std::pair<double, double> covered(const HeightMap& m, int i0, int i1, int j0, int j1) {
  const auto cell = [&](int i, int j) {
    return m.has(i, j) && m.has(i + 1, j) && m.has(i, j + 1) && m.has(i + 1, j + 1);
  };
  double area = 0, edge = 0;
  for (int j = j0 - 1; j <= j1; ++j) {
    for (int i = i0 - 1; i <= i1; ++i) {
      area += 0.25 * cell(i, j);
      edge += 0.5 * (cell(i, j) != cell(i - 1, j)) + 0.5 * (cell(i, j) != cell(i, j - 1));
    }
  }
  return {area, edge};
}

TEST(Triangulate, CoversWhatExistsWithoutCracks) {
  // The area spans the borders of tiles, and has holes and a ragged edge.
  Stream random(6);
  std::set<std::pair<int, int>> missing;
  for (int k = 0; k < 300; ++k) {
    const int i = int(random.below(420)) - 100, j = int(random.below(300)) - 60;
    missing.insert({i, j});
  }
  const auto has = [&](int i, int j) {
    return !missing.count({i, j}) && std::hypot(i - 200, j - 100) > 25.5 && i + j / 3 < 310;
  };
  const HeightMap map = map_of(-100, 320, -60, 240, has, [](double x, double y) {
    return 0.5 * std::sin(x / 6) * std::cos(y / 9) + 0.05 * x;
  });
  const GroundMesh mesh = triangulate(map);
  const Check c = checked(mesh);
  const auto [area, edge] = covered(map, -100, 320, -60, 240);
  EXPECT_EQ(c.area, area);
  EXPECT_LE(c.longest, 10);
  double open = 0;
  for (const auto& [side, n] : c.sides) {
    EXPECT_EQ(n, 1);
    if (c.sides.count({side[1], side[0]})) continue;
    open += double((mesh.vertices[side[0]] - mesh.vertices[side[1]]).head<2>().norm());
  }
  EXPECT_NEAR(open, edge, 1e-6);  // triangles end only where the area ends
}

TEST(Triangulate, KeepsTheErrorAndFewTriangles) {
  const auto hill = [](double x, double y) { return 3 * std::exp(-(x * x + y * y) / 40); };
  const HeightMap map = map_of(
      -50, 50, -50, 50, [](int, int) { return true; }, hill);
  size_t last = 0;
  for (double error : {0.1, 0.03, 0.01, 0.0}) {
    const GroundMesh mesh = triangulate(map, {.max_error_m = error});
    for (const auto& t : mesh.triangles) {
      const Vec3f &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
      const double area = double((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x());
      const Vec3f low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
      for (float x = low.x(); x <= high.x(); x += 0.5f) {
        for (float y = low.y(); y <= high.y(); y += 0.5f) {
          const double wb = double((x - a.x()) * (c - a).y() - (y - a.y()) * (c - a).x()) / area;
          const double wc = double((b - a).x() * (y - a.y()) - (b - a).y() * (x - a.x())) / area;
          if (wb < 0 || wc < 0 || wb + wc > 1) continue;
          const double z = double(a.z()) + wb * double((b - a).z()) + wc * double((c - a).z());
          ASSERT_NEAR(z, hill(double(x), double(y)), error + 1e-5);
        }
      }
    }
    EXPECT_GT(mesh.triangles.size(), last);
    if (error == 0.03) {
      EXPECT_LT(mesh.triangles.size(), 5000u);  // of 20 000
    }
    last = mesh.triangles.size();
  }
}

TEST(Triangulate, ThreadsChangeNothing) {
  const HeightMap map = map_of(
      -270, 270, -10, 10, [](int i, int j) { return (i * j) % 37 != 1; },
      [](double x, double y) { return std::sin(x) * y * 0.1; });
  set_threads(1);
  const GroundMesh one = triangulate(map);
  set_threads(0);
  const GroundMesh all = triangulate(map);
  EXPECT_EQ(one.triangles, all.triangles);
  EXPECT_EQ(one.vertices, all.vertices);
}

TEST(Triangulate, DegenerateMaps) {
  EXPECT_TRUE(triangulate(HeightMap()).triangles.empty());
  const auto flat = [](double, double) { return 1.0; };
  const auto all = [](int, int) { return true; };
  EXPECT_TRUE(triangulate(map_of(3, 3, 4, 4, all, flat)).triangles.empty());
  EXPECT_TRUE(triangulate(map_of(3, 90, 4, 4, all, flat)).triangles.empty());
  EXPECT_EQ(triangulate(map_of(-1, 0, -1, 0, all, flat)).triangles.size(), 2u);
  EXPECT_THROW(triangulate(HeightMap(), {.max_error_m = -1}), std::invalid_argument);
  EXPECT_THROW(triangulate(HeightMap(), {.max_side_m = 0.5}), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::ground
