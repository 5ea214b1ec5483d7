#include "underbrush/ground/height_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/ground/height_sums.hpp"
#include "underbrush/ground/node_mask.hpp"

namespace underbrush::ground {
namespace {

/// Makes points of z(x, y) on [0, side]², with seed 3.
template <class Height>
std::vector<Vec3> scatter(const Height& height, size_t n, double side, double noise = 0,
                          const Vec3& at = Vec3::Zero()) {
  Stream random(3);
  std::vector<Vec3> points;
  for (size_t i = 0; i < n; ++i) {
    const double x = random.uniform(0, side), y = random.uniform(0, side);
    points.push_back(at + Vec3(x, y, height(x, y) + noise * random.normal()));
  }
  return points;
}

HeightMap fitted(const std::vector<Vec3>& points, const HeightGridOptions& options = {},
                 const Vec3& origin = Vec3::Zero()) {
  HeightGrid grid(origin, options);
  grid.add(points);
  return grid.solve();
}

TEST(HeightGrid, ReproducesAPlaneAlsoWhereThereAreNoPoints) {
  const auto plane = [](double x, double y) { return 3 + 0.4 * x - 0.2 * y; };
  std::vector<Vec3> points = scatter(plane, 20000, 30);
  std::erase_if(points, [](const Vec3& p) { return (p - Vec3(15, 15, p.z())).norm() < 4; });
  const HeightMap map = fitted(points);
  for (double x = -1; x < 31; x += 0.37) {
    for (double y = 0.1; y < 30; y += 0.41) {
      ASSERT_TRUE(map.at(x, y)) << x << " " << y;
      ASSERT_NEAR(*map.at(x, y), plane(x, y), 1e-6) << x << " " << y;
    }
  }
  EXPECT_LT(map.sigma_m, 1e-6);
}

TEST(HeightGrid, MinimisesWhatItSays) {
  // h is the stationary point of a quadratic energy, so every change of a node's height must raise
  // the energy.
  const std::vector<Vec3> points =
      scatter([](double x, double y) { return std::sin(x) * y; }, 60, 3);
  const HeightGridOptions o{.spacing_m = 0.5, .smoothness_m2 = 0.2};
  HeightMap map = fitted(points, o);
  const auto energy = [&] {
    double e = 0;
    for (const Vec3& p : points) e += std::pow(*map.at(p.x(), p.y()) - p.z(), 2);
    const double k = o.smoothness_m2 / (o.spacing_m * o.spacing_m);
    const auto all = [&](std::vector<std::pair<int, int>> n, std::vector<double> c) {
      double sum = 0;
      for (size_t m = 0; m < n.size(); ++m) {
        if (!map.has(n[m].first, n[m].second)) return 0.0;
        sum += c[m] * map.node(n[m].first, n[m].second);
      }
      return k * sum * sum;
    };
    for (int i = -20; i < 30; ++i) {
      for (int j = -20; j < 30; ++j) {
        e += all({{i, j}, {i + 1, j}, {i + 2, j}}, {1, -2, 1});
        e += all({{i, j}, {i, j + 1}, {i, j + 2}}, {1, -2, 1});
        e += 2 * all({{i, j}, {i + 1, j}, {i, j + 1}, {i + 1, j + 1}}, {1, -1, -1, 1});
      }
    }
    return e;
  };
  for (const auto& [i, j] : {std::pair{0, 0}, {2, 3}, {6, 6}, {3, 0}, {-2, 1}}) {
    ASSERT_TRUE(map.has(i, j));
    double& h = map.height.at(block_of(i, j))[size_t(place_in_block(i, j))];
    const double keep = h, step = 1e-3;
    h = keep + step;
    const double up = energy();
    h = keep - step;
    const double down = energy();
    h = keep;
    EXPECT_NEAR((up - down) / (2 * step), 0, 2e-6) << i << " " << j;
    EXPECT_GT(up + down - 2 * energy(), 0);
  }
  double squares = 0;
  for (const Vec3& p : points) squares += std::pow(*map.at(p.x(), p.y()) - p.z(), 2);
  EXPECT_NEAR(map.sigma_m, std::sqrt(squares / double(points.size())), 1e-9);
}

TEST(HeightGrid, AveragesNoiseAway) {
  const auto wave = [](double x, double y) {
    return 0.5 * std::sin(x / 5) + 0.3 * std::cos(y / 7);
  };
  const double noise = 0.05;
  double last = 1;
  for (size_t n : {4000, 16000, 64000}) {
    const HeightMap map = fitted(scatter(wave, n, 40, noise));
    double squares = 0;
    size_t count = 0;
    for (double x = 1; x < 39; x += 0.73) {
      for (double y = 1; y < 39; y += 0.71, ++count) {
        squares += std::pow(*map.at(x, y) - wave(x, y), 2);
      }
    }
    const double rms = std::sqrt(squares / double(count));
    EXPECT_LT(rms, last / 1.3) << n;
    last = rms;
    if (n == 64000) {
      EXPECT_NEAR(map.sigma_m, noise, 0.05 * noise);
    }
  }
  EXPECT_LT(last, 0.25 * noise);
}

TEST(HeightGrid, ConvergesWithTheSpacing) {
  const auto wave = [](double x, double y) { return std::sin(x) * std::cos(y); };
  double last = 0;
  for (double spacing : {0.5, 0.25, 0.125}) {
    const HeightMap map =
        fitted(scatter(wave, 60000, 10),
               {.spacing_m = spacing, .smoothness_m2 = 1e-6 * spacing, .padding_m = 1});
    double worst = 0;
    for (double x = 1; x < 9; x += 0.31) {
      for (double y = 1; y < 9; y += 0.29)
        worst = std::max(worst, std::abs(*map.at(x, y) - wave(x, y)));
    }
    if (last > 0) {
      EXPECT_NEAR(last / worst, 4, 1.6);  // second-order convergence
    }
    last = worst;
  }
}

TEST(HeightGrid, FarFromTheWorldsOriginItIsTheSame) {
  const auto hill = [](double x, double y) { return 0.1 * x + std::exp(-0.1 * (x - 5) * (y - 5)); };
  const Vec3 far(1048576, -2097152, 1024);
  const HeightMap here = fitted(scatter(hill, 3000, 10, 0.02));
  const HeightMap there = fitted(scatter(hill, 3000, 10, 0.02, far), {}, far);
  ASSERT_EQ(here.exists, there.exists);
  for (double x = 0; x < 10; x += 0.9) {
    for (double y = 0; y < 10; y += 0.9) {
      EXPECT_NEAR(*there.at(far.x() + x, far.y() + y) - far.z(), *here.at(x, y), 1e-7);
    }
  }
}

TEST(HeightGrid, PiecesMergeToTheWhole) {
  const std::vector<Vec3> points =
      scatter([](double x, double y) { return x * y / 50; }, 5000, 40, 0.1);
  HeightGrid merged(Vec3(1, 2, 3));
  for (size_t from = 0; from < points.size(); from += 1000) {
    HeightGrid piece(Vec3(1, 2, 3));
    piece.add(std::span(points).subspan(from, 1000));
    merged.merge(piece);
  }
  const HeightMap a = merged.solve(), b = fitted(points, {}, Vec3(1, 2, 3));
  ASSERT_EQ(a.exists, b.exists);
  EXPECT_EQ(merged.points(), points.size());
  EXPECT_NEAR(a.sigma_m, b.sigma_m, 1e-9);
  for (const Vec3& p : points) ASSERT_NEAR(*a.at(p.x(), p.y()), *b.at(p.x(), p.y()), 1e-6);
  EXPECT_THROW(merged.merge(HeightGrid(Vec3::Zero())), std::invalid_argument);
}

TEST(HeightSums, CoarsenedAreThoseOfNodesTwiceAsFarApart) {
  const std::vector<Vec3> points = scatter([](double x, double y) { return std::sin(x) + y / 9; },
                                           3000, 70, 0.1, Vec3(-31.3, -17.7, 5));
  HeightSums fine{Vec3::Zero(), {.spacing_m = 0.4}, {}},
      coarse{Vec3::Zero(), {.spacing_m = 0.8}, {}};
  fine.add(points);
  coarse.add(points);
  // A node on a block's border has sums in several blocks; they add up at the node.
  const auto at_nodes = [](const HeightSums& sums) {
    std::map<std::pair<int, int>, NodeSums> nodes;
    for (const auto& [key, block] : sums.blocks) {
      for (size_t k = 0; k < block.size(); ++k) {
        if (block[k].a[kSelf] == 0) continue;
        nodes[{key.x * kBlockSide + int(k % kSumSide), key.y * kBlockSide + int(k / kSumSide)}] +=
            block[k];
      }
    }
    return nodes;
  };
  const HeightSums made = fine.coarsened();
  EXPECT_EQ(made.options.spacing_m, 0.8);
  EXPECT_EQ(made.n, coarse.n);
  EXPECT_EQ(made.cells(), coarse.cells());
  const auto a = at_nodes(made), b = at_nodes(coarse);
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [node, sums] : b) {
    ASSERT_TRUE(a.contains(node)) << node.first << " " << node.second;
    for (int c = 0; c < kPointCouplings; ++c) {
      EXPECT_NEAR(a.at(node).a[c], sums.a[c], 1e-12)
          << node.first << " " << node.second << " " << c;
    }
    EXPECT_NEAR(a.at(node).b, sums.b, 1e-11);
  }
}

TEST(HeightGrid, NodesAreNoFinerThanThePoints) {
  const auto plane = [](double x, double y) { return 3 + 0.4 * x - 0.2 * y; };
  // points, on 60 m × 60 m: 12, 1, 0.25, 0.06 and 0.004 a square metre
  const std::pair<size_t, double> cases[] = {{43200, 0.5}, {3600, 1}, {900, 2}, {225, 4}, {15, 4}};
  for (const auto& [n, spacing] : cases) {
    const std::vector<Vec3> points = scatter(plane, n, 60);
    const HeightMap map = fitted(points);
    EXPECT_EQ(map.spacing_m, spacing) << n;
    for (const Vec3& p : points) ASSERT_NEAR(*map.at(p.x(), p.y()), p.z(), 1e-6) << n;
  }
  EXPECT_EQ(fitted(scatter(plane, 225, 60), {.spacing_m = 3}).spacing_m, 3);
  EXPECT_EQ(fitted(scatter(plane, 225, 60), {.coarsest_m = 0.5}).spacing_m, 0.5);
}

TEST(HeightGrid, ThreadsChangeNothing) {
  const std::vector<Vec3> points = scatter([](double x, double) { return x / 9; }, 5000, 90, 0.1);
  set_threads(1);
  const HeightMap one = fitted(points);
  set_threads(0);
  EXPECT_EQ(one.height, fitted(points).height);
}

TEST(HeightGrid, ReachesAsFarAsPaddingAndBridgeSay) {
  std::vector<Vec3> points;
  for (double x = 0; x <= 40; x += 0.25) {
    for (double y = 0; y <= 40; y += 0.25) {
      const bool narrow = x > 10 && x<18, wide = x> 24 && x < 36;
      if (!narrow && !wide) points.emplace_back(x, y, 0);
    }
  }
  const HeightMap map = fitted(points);
  EXPECT_TRUE(map.at(14, 20));   // an 8 m gap is bridged
  EXPECT_FALSE(map.at(30, 20));  // a 12 m gap is not
  EXPECT_TRUE(map.at(-1.2, 20));
  EXPECT_FALSE(map.at(-2.1, 20));
  EXPECT_TRUE(map.at(25.2, 20));
}

TEST(HeightGrid, MemoryFollowsTheAreaNotTheBoundingBox) {
  HeightGrid grid(Vec3::Zero());
  std::vector<Vec3> points;
  points.reserve(1000);
  for (int k = 0; k < 1000; ++k) points.emplace_back(100 * k, 37 * k, k);  // 107 km
  grid.add(points);
  const HeightMap map = grid.solve();
  EXPECT_LE(map.exists.size(), 4000u);
  EXPECT_NEAR(*map.at(50000, 18500), 500, 1e-6);
}

TEST(HeightGrid, DegenerateInput) {
  EXPECT_EQ(fitted({}).size(), 0u);
  EXPECT_FALSE(fitted({}).at(0, 0));
  const HeightMap one = fitted({{1, 1, 7}});
  EXPECT_NEAR(*one.at(1.7, 1.3), 7, 1e-5);
  const HeightMap two = fitted({{1, 1, 7}, {1, 1, 9}});
  EXPECT_NEAR(*two.at(1, 1), 8, 1e-5);
  EXPECT_NEAR(two.sigma_m, 1, 1e-9);
  std::vector<Vec3> line;
  line.reserve(100);
  for (int k = 0; k < 100; ++k) line.emplace_back(0.1 * k, 0.2 * k, 0.3 * k);
  const HeightMap lined = fitted(line);
  EXPECT_NEAR(*lined.at(5, 10), 15, 1e-5);
  HeightGrid grid(Vec3::Zero());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Vec3& bad : {Vec3(nan, 0, 0), Vec3(0, 0, nan), Vec3(1e18, 0, 0)}) {
    EXPECT_THROW(grid.add(std::vector<Vec3>{bad}), std::invalid_argument);
  }
  EXPECT_THROW(HeightGrid(Vec3::Zero(), {.spacing_m = 0}), std::invalid_argument);
}

TEST(NodeMask, NearIsWhatBruteForceFinds) {
  Stream random(11);
  std::vector<std::pair<int, int>> nodes;
  NodeMask mask;
  for (int k = 0; k < 25; ++k) {
    const int i = int(random.below(150)) - 70, j = int(random.below(150)) - 70;
    nodes.emplace_back(i, j);
    mask[block_of(i, j)][size_t(place_in_block(i, j))] = 1;
  }
  const auto in = [](const NodeMask& m, int i, int j) {
    const auto b = m.find(block_of(i, j));
    return b != m.end() && b->second[size_t(place_in_block(i, j))];
  };
  const NodeMask wide = dilated(mask, 37.2), back = eroded(wide, 12.5);
  for (int i = -120; i < 130; i += 3) {
    for (int j = -120; j < 130; j += 3) {
      bool near = false;
      for (const auto& [a, b] : nodes) near |= std::hypot(a - i, b - j) <= 37.2;
      ASSERT_EQ(in(wide, i, j), near) << i << " " << j;
      bool inside = true;
      for (int a = -13; a < 14; ++a) {
        for (int b = -13; b < 14; ++b) {
          inside &= std::hypot(a, b) > 12.5 || in(wide, i + a, j + b);
        }
      }
      ASSERT_EQ(in(back, i, j), inside) << i << " " << j;
    }
  }
}

}  // namespace
}  // namespace underbrush::ground
