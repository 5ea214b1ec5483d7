#include "underbrush/perception/occupancy_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>

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

// The vehicle is far out and has turned, and beams leave the grid on all sides.
TEST(OccupancyGrid, TheOrderOfTheBeamsHasNoEffect) {
  Stream random(5);
  MergedCloud cloud = test::empty_cloud(0), reverse = test::empty_cloud(0);
  std::vector<Vec3> points;
  for (int k = 0; k < 5000; ++k) {
    points.emplace_back(random.uniform(-60, 60), random.uniform(-60, 60), random.uniform(-1, 4));
  }
  for (const Vec3& p : points) test::add_point(cloud, p);
  for (auto p = points.rbegin(); p != points.rend(); ++p) test::add_point(reverse, *p);
  OccupancyGrid one, other;
  for (OccupancyGrid* grid : {&one, &other}) {
    MergedCloud& c = grid == &one ? cloud : reverse;
    c.world_from_vehicle.translation = {5e6 + 0.3, -4e5, 120};
    c.world_from_vehicle.rotation = Eigen::AngleAxisd(2.5, Vec3::UnitZ());
    grid->step(c);
  }
  size_t known = 0;
  for (size_t cell = 0; cell < one.columns() * one.columns(); ++cell) {
    ASSERT_EQ(one.probability(cell), other.probability(cell));
    known += one.probability(cell)[kFree] != GridOptions{}.prior[kFree];
  }
  EXPECT_GT(known, one.columns() * one.columns() / 4);
}

// Hits and passes against the pieces of each beam between its sorted crossings of all borders.
TEST(OccupancyGrid, CountsThePiecesBetweenAllCrossings) {
  GridOptions options = keep_all();
  options.half_side_m = 8;
  options.prior = {0.5, 0, 0.5};
  options.most_evidence = 1e6;
  Stream random(33);
  for (int trial = 0; trial < 200; ++trial) {
    OccupancyGrid grid(options);
    MergedCloud cloud = test::empty_cloud(0);
    const Vec3 end(random.uniform(-12, 12), random.uniform(-12, 12), random.uniform(-0.5, 3));
    test::add_point(cloud, end);
    cloud.sensor_m = {Vec3f(0.07f, 0.03f, 1)};  // on no border of cells
    grid.step(cloud);
    std::vector<int> seen(grid.columns() * grid.columns());
    const Vec3 from = cloud.sensor_m[0].cast<double>(), stop = end.cast<float>().cast<double>();
    std::vector<double> crossings{0, 1, (options.low_m - from.z()) / (stop - from).z(),
                                  (options.high_m - from.z()) / (stop - from).z()};
    for (int line = -60; line <= 60; ++line) {
      for (int axis = 0; axis < 2; ++axis) {
        crossings.push_back((0.2 * line - from[axis]) / (stop - from)[axis]);
      }
    }
    std::sort(crossings.begin(), crossings.end());
    for (size_t k = 1; k < crossings.size(); ++k) {
      const double middle = (crossings[k - 1] + crossings[k]) / 2;
      const Vec3 p = from + middle * (stop - from);
      if (middle < 0 || middle > 1 || p.z() < options.low_m || p.z() > options.high_m) continue;
      if (const auto cell = grid.cell_at(p.x(), p.y())) seen[*cell] = 1;
    }
    const auto last = grid.cell_at(stop.x(), stop.y());
    if (last && stop.z() > options.low_m && stop.z() < options.high_m) seen[*last] = 2;
    const double pass = std::log(0.05 / 0.98), hit = std::log(0.95 / 0.02);
    for (size_t cell = 0; cell < seen.size(); ++cell) {
      const auto p = grid.probability(cell);
      const double expected = seen[cell] == 2 ? hit : seen[cell] == 1 ? pass : 0;
      ASSERT_NEAR(std::log(p[kSolid] / p[kFree]), expected, 1e-4) << trial << " " << cell;
    }
  }
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
