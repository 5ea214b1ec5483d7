#include "underbrush/movers/find_movers.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::movers {
namespace {

// What a beam of the scene met.
enum Thing : uint8_t { kNothing, kGround, kWall, kParked, kBush, kCar };

struct Recording {
  BeamLog log;
  std::vector<Thing> thing;
};

// The range at which a ray enters a box, or infinity.
double box_range(const Vec3& from, const Vec3& d, const Vec3& centre, const Vec3& half) {
  double begin = 0, end = INFINITY;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (centre[axis] - half[axis] - from[axis]) / d[axis];
    const double b = (centre[axis] + half[axis] - from[axis]) / d[axis];
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  return begin < end ? begin : INFINITY;
}

struct SceneOptions {
  double car_m_s = 6, sensor_m_s = 0;
  int scans = 100;
};

// A yard with a wall around it, a parked car, a bush that stops three beams of ten, and a car that
// drives through it; ten scans a second. The sensor may drive, too, and each beam has its origin.
Recording record(const SceneOptions& options) {
  Recording out;
  Stream random(7);
  for (int scan = 0; scan < options.scans; ++scan) {
    for (int step = 0; step < 720; ++step) {
      const double t = 0.1 * (scan + step / 720.0), bearing = step * M_PI / 360;
      const Vec3 from(options.sensor_m_s * t, 0, 1.8);
      const Vec3 car(-30 + options.car_m_s * t, 8, 0.8);
      for (int ring = 0; ring < 24; ++ring) {
        const double e = (ring - 18) * M_PI / 180;
        const Vec3 d(std::cos(bearing) * std::cos(e), std::sin(bearing) * std::cos(e), std::sin(e));
        std::array<double, 6> range;
        range.fill(INFINITY);
        if (d.z() < 0) range[kGround] = -from.z() / d.z();
        const double b = d.head<2>().dot(from.head<2>()), a = d.head<2>().squaredNorm();
        range[kWall] = (-b + std::sqrt(b * b - a * (from.head<2>().squaredNorm() - 1225))) / a;
        if (from.z() + range[kWall] * d.z() > 4) range[kWall] = INFINITY;
        range[kParked] = box_range(from, d, {5, -9, 0.8}, {2.2, 0.9, 0.8});
        range[kCar] = box_range(from, d, car, {2.2, 0.9, 0.8});
        const double bush = box_range(from, d, {-10, -8, 1}, {2, 2, 1});
        if (random.uniform() < 0.3) range[kBush] = bush + random.uniform(0, 3);
        const auto nearest = std::min_element(range.begin(), range.end());
        const size_t i = out.log.size();
        out.log.resize(i + 1);
        out.log.origin[i] = from;
        out.log.direction[i] = d.cast<float>();
        out.log.time_s[i] = t;
        out.log.ring[i] = uint16_t(ring);
        out.log.scan[i] = uint32_t(scan);
        const bool is_hit = *nearest < 120;
        out.log.range_m[i] = is_hit ? float(*nearest + 0.02 * random.normal()) : kMiss;
        out.thing.push_back(is_hit ? Thing(nearest - range.begin()) : kNothing);
      }
    }
  }
  return out;
}

// Marked returns and all returns of each thing.
std::array<std::array<double, 2>, 6> counts(const Recording& r, const std::vector<uint8_t>& mark) {
  std::array<std::array<double, 2>, 6> out{};
  for (size_t i = 0; i < mark.size(); ++i) {
    out[r.thing[i]][0] += mark[i];
    ++out[r.thing[i]][1];
  }
  return out;
}

class Drive : public testing::TestWithParam<double> {};

TEST_P(Drive, MarksTheDrivingCarAndNothingElse) {
  const Recording r = record({.sensor_m_s = GetParam()});
  MemorySource source(r.log);
  const auto mark = find_movers(source);
  const auto count = counts(r, mark);
  ASSERT_GT(count[kCar][1], 5000);
  EXPECT_GT(count[kCar][0] / count[kCar][1], 0.7);
  // What is near the ground looks like ground, and far away a car has few returns.
  double marked = 0, all = 0;
  for (size_t i = 0; i < mark.size(); ++i) {
    if (r.thing[i] != kCar || r.log.end_point(i).z() < 0.5 || r.log.range_m[i] > 20) continue;
    marked += mark[i];
    ++all;
  }
  EXPECT_GT(marked / all, 0.95);
  ASSERT_GT(count[kParked][1], 5000);
  EXPECT_EQ(count[kParked][0], 0);
  ASSERT_GT(count[kBush][1], 5000);
  EXPECT_LT(count[kBush][0] / count[kBush][1], 0.005);
  EXPECT_LT(count[kGround][0] / count[kGround][1], 0.001);
  EXPECT_LT(count[kWall][0] / count[kWall][1], 0.001);
  EXPECT_EQ(count[kNothing][0], 0);
}
INSTANTIATE_TEST_SUITE_P(, Drive, testing::Values(0.0, 1.5));

TEST(FindMovers, MarksNothingWhereNothingMoves) {
  const Recording r = record({.car_m_s = 0, .sensor_m_s = 1.5, .scans = 60});
  MemorySource source(r.log);
  const auto count = counts(r, find_movers(source));
  double marked = 0;
  for (const auto& [of, all] : count) marked += of;
  EXPECT_LT(marked, 1e-4 * double(r.log.size()));
}

TEST(FindMovers, DependsNeitherOnThreadsNorOnChunks) {
  const Recording r = record({.scans = 50});
  MemorySource source(r.log), small(r.log, 12345);
  const auto mark = find_movers(source);
  EXPECT_EQ(find_movers(small), mark);
  set_threads(1);
  EXPECT_EQ(find_movers(source), mark);
  set_threads(0);
}

TEST(FindMovers, AnEmptyLogAndOneScanHaveNone) {
  const BeamLog empty;
  MemorySource none(empty);
  EXPECT_TRUE(find_movers(none).empty());
  const Recording r = record({.scans = 1});
  MemorySource one(r.log);
  const auto mark = find_movers(one);
  EXPECT_EQ(std::count(mark.begin(), mark.end(), 1), 0);
}

TEST(FindMovers, RefusesOptionsOutOfRange) {
  const BeamLog empty;
  MemorySource source(empty);
  EXPECT_THROW(find_movers(source, {.look_s = {}}), std::invalid_argument);
  EXPECT_THROW(find_movers(source, {.look_s = {1, 0.5}}), std::invalid_argument);
  EXPECT_THROW(find_movers(source, {.least_empty = 0}), std::invalid_argument);
  EXPECT_THROW(find_movers(source, {.cell_deg = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::movers
