#include "underbrush/perception/occupancy_grid.hpp"

#include <gtest/gtest.h>

#include "clouds.hpp"

namespace underbrush::perception {
namespace {

enum State { kFree, kPermeable, kSolid };

std::array<double, 3> at(const OccupancyGrid& grid, double x, double y) {
  return grid.probability(*grid.cell_at(x, y));
}

GridOptions keep_all() {
  GridOptions options;
  options.memory = 1;
  return options;
}

TEST(OccupancyGrid, IsBayesRule) {
  const GridOptions o = keep_all();
  OccupancyGrid grid(o);
  MergedCloud cloud = test::empty_cloud(0);
  // Three beams end in a cell, and two pass through it.
  for (int k = 0; k < 3; ++k) test::add_point(cloud, {10.1, 0.1, 1});
  for (int k = 0; k < 2; ++k) test::add_point(cloud, {20.1, 0.2, 1});
  grid.step(cloud);
  std::array<double, 3> expected{};
  double sum = 0;
  for (size_t s = 0; s < 3; ++s) {
    expected[s] = o.prior[s] * std::pow(o.hit[s], 3) * std::pow(1 - o.hit[s], 2);
    sum += expected[s];
  }
  for (size_t s = 0; s < 3; ++s) EXPECT_NEAR(at(grid, 10.1, 0.1)[s], expected[s] / sum, 1e-5);
  for (size_t s = 0; s < 3; ++s) EXPECT_NEAR(at(grid, 10.1, 5)[s], o.prior[s], 1e-12);
}

TEST(OccupancyGrid, TellsAWallFromGrassAndFromNothing) {
  OccupancyGrid grid(keep_all());
  Stream random(8);
  for (int cycle = 0; cycle < 10; ++cycle) {
    MergedCloud cloud = test::empty_cloud(cycle);
    for (int k = 0; k < 6; ++k) {
      test::add_point(cloud, {12.1, 0.1, 1});  // A wall.
      // Grass at 8 m stops two beams of five; the others meet a wall behind.
      test::add_point(cloud, random.uniform() < 0.4 ? Vec3(8.1, 4.1, 1) : Vec3(16.2, 8.2, 1));
    }
    grid.step(cloud);
  }
  EXPECT_GT(at(grid, 12.1, 0.1)[kSolid], 0.99);
  EXPECT_GT(at(grid, 8.1, 4.1)[kPermeable], 0.99);
  EXPECT_GT(at(grid, 5.0, 0.05)[kFree], 0.99);
}

TEST(OccupancyGrid, WithoutPermeableMatterItIsTheUsualLogOdds) {
  GridOptions options = keep_all();
  options.prior = {0.5, 0, 0.5};
  OccupancyGrid grid(options);
  MergedCloud cloud = test::empty_cloud(0);
  test::add_point(cloud, {10.1, 0.1, 1});
  grid.step(cloud);
  const auto p = at(grid, 10.1, 0.1);
  EXPECT_NEAR(std::log(p[kSolid] / p[kFree]), std::log(0.95 / 0.02), 1e-5);
  EXPECT_EQ(p[kPermeable], 0);
  const auto passed = at(grid, 5.1, 0.05);
  EXPECT_NEAR(std::log(passed[kSolid] / passed[kFree]), std::log(0.05 / 0.98), 1e-5);
}

TEST(OccupancyGrid, BeamsThatEndOnTheGroundShowFreeSpaceAndNoObstacle) {
  OccupancyGrid grid(keep_all());
  MergedCloud cloud = test::empty_cloud(0);
  for (int k = 0; k < 5; ++k) test::add_point(cloud, {10.1, 0.1, 0});
  grid.step(cloud);
  EXPECT_GT(at(grid, 5.1, 0.05)[kFree], 0.9);
  // The last metres of the beam are below the band, so nothing is known there.
  EXPECT_EQ(at(grid, 10.1, 0.1)[kFree], GridOptions{}.prior[0]);
}

TEST(OccupancyGrid, MissesShowFreeSpace) {
  OccupancyGrid grid(keep_all());
  MergedCloud cloud = test::empty_cloud(0);
  for (int k = 0; k < 20; ++k) {
    cloud.miss_m.emplace_back(100, 0.1, 1);
    cloud.miss_sensor.push_back(0);
  }
  grid.step(cloud);
  EXPECT_GT(at(grid, 30, 0.05)[kFree], 0.99);
}

TEST(OccupancyGrid, StaysInPlaceWhenTheVehicleMoves) {
  OccupancyGrid grid(keep_all());
  MergedCloud cloud = test::empty_cloud(0);
  for (int k = 0; k < 5; ++k) test::add_point(cloud, {10.1, 0.1, 1});
  grid.step(cloud);
  const auto before = at(grid, 10.1, 0.1);
  MergedCloud later = test::empty_cloud(1);
  later.world_from_vehicle.translation = {7.3, -2.9, 0};
  grid.step(later);
  EXPECT_EQ(at(grid, 10.1, 0.1), before);
  EXPECT_FALSE(grid.cell_at(-40, 0));
}

// Every cell on a beam gets its pass once, whatever the direction.
TEST(OccupancyGrid, EnteredCellsAreThoseOnTheBeam) {
  GridOptions options = keep_all();
  options.prior = {0.5, 0, 0.5};
  Stream random(21);
  for (int trial = 0; trial < 50; ++trial) {
    OccupancyGrid grid(options);
    MergedCloud cloud = test::empty_cloud(0);
    const double bearing = random.uniform(-M_PI, M_PI);
    const Vec3 end(9 * std::cos(bearing), 9 * std::sin(bearing), 1);
    test::add_point(cloud, end);
    grid.step(cloud);
    for (double r = 0.05; r < 8.6; r += 0.01) {
      const auto p = at(grid, r * std::cos(bearing), r * std::sin(bearing));
      const double odds = std::log(p[kSolid] / p[kFree]);
      ASSERT_NEAR(odds, std::log(0.05 / 0.98), 1e-4) << bearing << " " << r;
    }
  }
}

}  // namespace
}  // namespace underbrush::perception
