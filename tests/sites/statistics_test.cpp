#include "underbrush/sites/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "primitives/sites.hpp"
#include "underbrush/sites/distances.hpp"
#include "underbrush/sites/ground_waves.hpp"

namespace underbrush::sites {
namespace {

using elements::Class;
using primitives::GroundSurface;
using primitives::PlacedObject;

double value_of(const std::vector<Statistic>& all, const std::string& name) {
  for (const Statistic& s : all) {
    if (s.name == name) return s.value;
  }
  ADD_FAILURE() << "no statistic " << name;
  return NAN;
}

PlacedObject tree(double x, double y, double length_m, double width_m, double height_m) {
  PlacedObject o;
  o.label = Class::kMediumTree;
  o.position = Vec3(x, y, 0);
  o.box = {Vec3(-length_m / 2, -width_m / 2, 0), Vec3(length_m / 2, width_m / 2, height_m)};
  return o;
}

TEST(SiteStatistics, DistancesToTheNearestAreThoseOfASlowSearch) {
  Stream random(1);
  std::vector<Eigen::Vector2d> a, b;
  for (int k = 0; k < 300; ++k) {
    const double x = random.uniform(-50, 50), y = random.uniform(-20, 20);
    (k % 5 ? a : b).emplace_back(x, y);
  }
  b.emplace_back(300, 10);
  for (const auto& [from, to] : {std::pair(a, a), {a, b}, {b, a}, {b, b}}) {
    const std::vector<double> found = nearest_distances(from, to);
    for (size_t k = 0; k < from.size(); ++k) {
      double nearest = INFINITY;
      for (const Eigen::Vector2d& p : to) {
        const double d = (p - from[k]).norm();
        if (d > 0) nearest = std::min(nearest, d);
      }
      EXPECT_EQ(found[k], nearest);
    }
  }
  EXPECT_EQ(nearest_distances(a, {})[0], INFINITY);
  EXPECT_EQ(nearest_distances(std::vector{a[0]}, std::vector{a[0]})[0], INFINITY);
}

TEST(SiteStatistics, AreThoseOfAKnownSite) {
  const elements::Model model = test::plane(50, 0, 0);
  const GroundSurface ground(model);
  const Window window(ground);
  EXPECT_NEAR(window.area_m2(), 1e4, 0.021e4);
  std::vector<PlacedObject> objects;
  for (int k = 0; k < 25; ++k) {  // A grid of 15 m of turned ellipses.
    objects.push_back(tree(-20 + 15 * (k % 5), -50 + 15 * (k / 5), 9, 6, 5 + k));
    objects.back().yaw_rad = 0.3 * k;
  }
  PlacedObject shrub = tree(13, -20, 1, 1, 0.7);
  shrub.label = Class::kSmallShrub;
  objects.push_back(shrub);
  objects.push_back(tree(1000, 0, 9, 6, 100));  // Outside of the window.
  const std::vector<Statistic> s = statistics_of(window, objects);
  EXPECT_NEAR(value_of(s, "trees per hectare"), 25 * 1e4 / window.area_m2(), 1e-9);
  EXPECT_NEAR(value_of(s, "tree to nearest tree, mean"), 15, 1e-9);
  EXPECT_NEAR(value_of(s, "tree height, mean"), 17, 1e-9);
  EXPECT_NEAR(value_of(s, "tree width, mean"), 7.5, 1e-9);
  EXPECT_NEAR(value_of(s, "shrub to nearest tree, mean"), 3, 1e-9);
  const double share = 25 * M_PI * 4.5 * 3 / window.area_m2();
  EXPECT_NEAR(value_of(s, "cover of trees"), share, 0.05 * share);
  EXPECT_EQ(value_of(s, "cover of patches"), 0);
  EXPECT_TRUE(std::isnan(value_of(s, "shrub to nearest shrub, mean")));
}

TEST(SiteWindow, KeepsTheAreaThatObjectsCover) {
  const elements::Model model = test::plane(100, 0, 0);  // 200 m × 200 m about (10, −20)
  const GroundSurface ground(model);
  Stream random(2);
  std::vector<Eigen::Vector2d> west;
  for (int k = 0; k < 400; ++k) {
    const double x = random.uniform(-90, 10), y = random.uniform(-120, 80);
    west.emplace_back(x, y);
  }
  Window window(ground);
  window.keep_around(west);
  EXPECT_NEAR(window.area_m2(), 2e4, 0.06 * 2e4);
  EXPECT_FALSE(window.contains({60, 0}));
  size_t inside = 0;
  for (const Eigen::Vector2d& p : west) inside += window.contains(p);
  EXPECT_GT(inside, 395u);
  for (int k = 0; k < 1000; ++k) EXPECT_TRUE(window.contains(window.draw(random)));
}

elements::Model with_ground(elements::TriangleMesh mesh) {
  elements::Model out;
  out.ground = std::move(mesh);
  return out;
}

TEST(GroundWaves, HaveTheStructureOfTheirSpectrum) {
  GroundSpectrum spectrum;
  spectrum.slope = {0.1, -0.05};
  spectrum.bands = {{8, 0.1}};
  double square[3] = {};
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const elements::Model m = with_ground(ground_with(spectrum, {100, 80}, 0.5, seed));
    const GroundStructure s = structure_of(GroundSurface(m));
    EXPECT_NEAR(s.slope.x(), 0.1, 0.01);
    EXPECT_NEAR(s.slope.y(), -0.05, 0.01);
    for (size_t k = 0; k < 3; ++k) square[k] += s.square_m2.at(k) / 10;
  }
  for (const size_t k : {0, 1, 2}) {
    const double lag = double(1 << k);
    const double expected = 2 * 0.01 * (1 - std::cyl_bessel_j(0, 2 * M_PI * lag / 8));
    EXPECT_NEAR(square[k], expected, 0.15 * expected) << lag;
  }
}

TEST(GroundWaves, AFittedSpectrumGivesTheGroundsStructure) {
  // A structure that grows as a power, as that of terrain does.
  GroundStructure wanted;
  for (double lag = 1; lag <= 64; lag *= 2) {
    wanted.lag_m.push_back(lag);
    wanted.square_m2.push_back(1e-3 * std::pow(lag, 1.4));
  }
  const GroundSpectrum spectrum = spectrum_of(wanted);
  std::vector<double> square(wanted.lag_m.size());
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const elements::Model m = with_ground(ground_with(spectrum, {160, 160}, 1, seed));
    const GroundStructure s = structure_of(GroundSurface(m));
    for (size_t k = 0; k < square.size(); ++k) square[k] += s.square_m2.at(k) / 6;
  }
  for (size_t k = 0; k < 5; ++k) {  // Longer waves are partly in the mean plane.
    EXPECT_NEAR(square[k] / wanted.square_m2[k], 1, 0.2) << wanted.lag_m[k];
  }
}

}  // namespace
}  // namespace underbrush::sites
