#include "underbrush/credit/crossing_beams.hpp"

#include <gtest/gtest.h>

#include "underbrush/core/rng.hpp"

namespace underbrush::credit {
namespace {

using Point = Eigen::Vector2d;

/// Whether a point of the way, of many, lies in one of the boxes; the boxes end at borders of
/// cells.
bool crosses_slowly(const std::vector<std::pair<Point, Point>>& boxes, const Point& from,
                    const Point& step) {
  constexpr int kPoints = 20000;
  for (int k = 0; k <= kPoints; ++k) {
    const Point p = from + step * (double(k) / kPoints);
    for (const auto& [low, high] : boxes) {
      if ((p.array() >= low.array()).all() && (p.array() < high.array()).all()) return true;
    }
  }
  return false;
}

TEST(CrossingBeams, AreaIsCrossedWhereAPointOfTheWayLiesInIt) {
  Stream random(3);
  const Point low(-100, -60), high(99, 59);
  const std::vector<std::pair<Point, Point>> boxes{
      {{-8, -8}, {4, 0}}, {{40, 20}, {44, 24}}, {{-100, 40}, {-60, 44}}};
  GroundArea area(low, high);
  for (const auto& [a, b] : boxes) area.add(a, b - Point::Constant(1e-6));
  int crossed = 0;
  for (int k = 0; k < 400; ++k) {
    const double x = random.uniform(-150, 150), y = random.uniform(-100, 100);
    const double dx = random.uniform(-120, 120), dy = random.uniform(-120, 120);
    const bool slow = crosses_slowly(boxes, {x, y}, {dx, dy});
    EXPECT_EQ(area.is_crossed({x, y}, {dx, dy}), slow) << x << " " << y << " " << dx << " " << dy;
    crossed += slow;
  }
  EXPECT_GT(crossed, 20);
  EXPECT_TRUE(area.is_crossed({0, -30}, {0, 60}));
  EXPECT_FALSE(area.is_crossed({10, -30}, {0, 60}));
  EXPECT_TRUE(area.is_crossed({1, -1}, {0, 0}));
  EXPECT_FALSE(area.is_crossed({1, 1}, {0, 0}));
}

BeamLog three_beams() {
  BeamLog log;
  log.info.max_range_m = 100;
  log.resize(3);
  const float ranges[] = {10, kMiss, 50};
  for (size_t i = 0; i < 3; ++i) {
    log.direction[i] = Vec3f(1, 0, 0);
    log.range_m[i] = ranges[i];
    log.scan[i] = uint32_t(i);
  }
  return log;
}

TEST(CrossingBeams, BeamsEndAtTheirReturnsAndMissesAtTheLargestRange) {
  const BeamLog log = three_beams();
  GroundArea area({-100, -100}, {100, 100});
  area.add({60, -1}, {63, 1});
  for (const auto& [max_range, scans] :
       {std::pair{90.0, std::vector<uint32_t>{1}}, std::pair{40.0, std::vector<uint32_t>{}}}) {
    MemorySource source(log, 2);
    CrossingBeams crossing(source, area, Vec3::Zero(), max_range, 0.75);
    std::vector<uint32_t> found;
    crossing.rewind();
    for (BeamLog chunk; crossing.next(chunk);) {
      found.insert(found.end(), chunk.scan.begin(), chunk.scan.end());
    }
    EXPECT_EQ(found, scans);
  }
}

TEST(CrossingBeams, JoinedLogsFollowOneAnother) {
  const BeamLog log = three_beams();
  MemorySource a(log, 2), b(log);
  JoinedBeams joined({&a, &b});
  EXPECT_EQ(joined.size(), 6u);
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<uint32_t> found;
    joined.rewind();
    for (BeamLog chunk; joined.next(chunk);) {
      found.insert(found.end(), chunk.scan.begin(), chunk.scan.end());
    }
    EXPECT_EQ(found, (std::vector<uint32_t>{0, 1, 2, 0, 1, 2}));
  }
}

}  // namespace
}  // namespace underbrush::credit
