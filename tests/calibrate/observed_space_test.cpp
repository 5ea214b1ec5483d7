#include "underbrush/calibrate/observed_space.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "underbrush/calibrate/observed_map.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/trace/unknown_space.hpp"

namespace underbrush::calibrate {
namespace {

constexpr double kDensity = 0.05;  // 1/m
constexpr double kTopM = 4, kReachM = 60;

/// A model of flat ground.
elements::Model flat_model() {
  elements::Model m;
  for (int x = -20; x <= 120; x += 2) {
    for (int y = -70; y <= 70; y += 2) m.ground.vertices.emplace_back(float(x), float(y), 0.0f);
  }
  return m;
}

/// The number of beams that crossed a cell, by a map.
int beams_of(const elements::ObservedSpace& space, const Cell3& cell) {
  using elements::ObservedBlock;
  for (const ObservedBlock& b : space.blocks) {
    if (b.at == ObservedBlock::of(cell)) return b.beams[ObservedBlock::index(cell)];
  }
  return 0;
}

/// Beams of a sensor that drives along x at a height of 1.5 m, to all sides and with slopes between
/// two. `range_of(direction, random)` gives their ranges, m.
template <class F>
BeamLog log_of_drive(size_t beams, uint64_t seed, double least_slope, double most_slope,
                     F range_of) {
  BeamLog log;
  log.info.max_range_m = kReachM;
  log.info.has_misses = true;
  log.resize(beams);
  Stream random(seed);
  for (size_t i = 0; i < beams; ++i) {
    const double along = double(i) / double(beams);
    log.scan[i] = uint32_t(100 * along);
    log.origin[i] = Vec3(100 * along, 0, 1.5);
    const double azimuth = random.uniform(0, 2 * M_PI);
    const double slope = random.uniform(least_slope, most_slope);
    log.direction[i] = Vec3(std::cos(azimuth), std::sin(azimuth), slope).normalized().cast<float>();
    const double range = range_of(log.direction[i].cast<double>(), random);
    log.range_m[i] = range < kReachM ? float(range) : kMiss;
  }
  return log;
}

/// A drive through a medium of one density up to a height over flat ground. Each beam meets its own
/// medium.
BeamLog log_in_medium(size_t beams, double top_m = kTopM) {
  return log_of_drive(beams, 7, -0.1, 0.1, [top_m](const Vec3& d, Stream& random) {
    const double ground = d.z() < 0 ? -1.5 / d.z() : HUGE_VAL;
    const double top = d.z() > 0 ? (top_m - 1.5) / d.z() : HUGE_VAL;
    const double free = -std::log1p(-random.uniform()) / kDensity;
    return free < top ? std::min(free, ground) : HUGE_VAL;
  });
}

/// A drive over flat ground that ends at `edge_m` on the right. Beyond the edge nothing returns.
BeamLog log_of_edge(double edge_m, size_t beams) {
  return log_of_drive(beams, 11, -0.3, -0.03, [edge_m](const Vec3& d, Stream&) {
    const double ground = -1.5 / d.z();
    return ground * d.y() < -edge_m ? HUGE_VAL : ground;
  });
}

TEST(ObservedSpace, KnowsTheCellsThatBeamsCrossedAndNoOthers) {
  elements::Model m = flat_model();
  BeamLog log;
  log.info.max_range_m = 60;
  log.info.has_misses = true;
  log.resize(3);
  for (size_t i = 0; i < 3; ++i) {
    log.scan[i] = uint32_t(i);
    log.origin[i] = Vec3(0.5, 0.5, 1.5);
    log.direction[i] = Vec3f::UnitX();
    log.range_m[i] = 10;
  }
  MemorySource source(log);
  learn_observed_space(m, source, {1, 0});
  ASSERT_TRUE(m.observed);
  m.observed->check();
  const trace::CrossedCells cells(*m.observed);
  for (const Cell3& cell : {Cell3{0, 0, 1}, {5, 0, 1}, {10, 0, 1}, {11, 0, 1}, {5, 1, 1}}) {
    const int beams = cell.y == 0 && cell.x <= 10 ? 3 : 0;
    EXPECT_EQ(beams_of(*m.observed, cell), beams) << cell.x;
    EXPECT_EQ(cells.holds(cell), beams > 0) << cell.x;
  }
  update_observed_space(m, source, 0);
  EXPECT_EQ(beams_of(*m.observed, {10, 0, 1}), 6);
  learn_observed_space(m, source, {0, 0});
  EXPECT_FALSE(m.observed);
}

TEST(ObservedSpace, OfBeamsWithoutAReturnEndsWhateverTheRangeOfTheSensor) {
  BeamLog log = log_of_drive(200, 3, -0.1, 0.1,
                             [](const Vec3& d, Stream&) { return d.y() > 0 ? HUGE_VAL : 20.0; });
  for (auto& d : log.direction) {
    if (d.y() > 0) d.z() = -1e-5f;
  }
  std::array<size_t, 2> blocks{};
  for (size_t k = 0; k < 2; ++k) {
    elements::Model m = flat_model();
    m.max_range_m = log.info.max_range_m = k == 0 ? 4000 : 65536;
    MemorySource source(log);
    learn_observed_space(m, source, {1, 0});
    ASSERT_TRUE(m.observed);
    blocks[k] = m.observed->blocks.size();
  }
  EXPECT_GT(blocks[0], 1000u);
  EXPECT_EQ(blocks[0], blocks[1]);
}

// The top of the medium lies within an interval of the heights.
TEST(ObservedSpace, EndsAtTheHighestReturns) {
  constexpr double kTop = 5.5;
  elements::Model m = flat_model();
  const BeamLog log = log_in_medium(60000, kTop);
  MemorySource source(log);
  learn_observed_space(m, source, {1, 0});
  ASSERT_TRUE(m.observed);
  EXPECT_NEAR(m.observed->top_m, kTop, 0.1);
  const size_t height = elements::ObservedSpace::height_interval(5),
               range = elements::ObservedSpace::range_interval(30);
  EXPECT_NEAR(double(m.observed->density_per_m[height][range]) / kDensity, 1, 0.3);
  const trace::UnknownSpace unknown(*m.observed, m.ground, m.origin);
  size_t ends = 0;
  for (uint64_t key = 0; key < 2000; ++key) {
    const Ray down{{-5.5, 60.5, 20}, Vec3(0, 0, -1)};
    const auto end = unknown.drawn_end(down, key, {0, kReachM});
    if (!end) continue;
    ++ends;
    EXPECT_LT(20 - *end, kTop + 1);  // the step of a cell in which the top lies
  }
  EXPECT_GT(ends, 200u);
}

TEST(ObservedMap, CountsTheBeamsOfAWalkStepByStep) {
  constexpr double kCell = 0.75;
  ObservedMap map(kCell);
  std::map<Cell3, int> expected;
  Stream random(15);
  for (int beam = 0; beam < 8000; ++beam) {
    const Vec3 origin(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const Vec3 direction =
        Vec3(random.normal(), random.normal(), 0.2 * random.normal()).normalized();
    const double from = beam % 3, to = random.uniform(0.5, 30);
    map.add(origin, direction, from, to);
    const Cell3 end = cell_of(Vec3(origin + to * direction), kCell);
    Cell3 last{INT32_MAX, 0, 0};
    for (double t = from; t < to; t += kCell / 2) {
      const Cell3 cell = cell_of(Vec3(origin + t * direction), kCell);
      expected[cell] += !(cell == last);
      last = cell;
    }
    expected[end] += !(end == last);
  }
  const elements::ObservedSpace space = map.space();
  int fullest = 0;
  size_t crossed = 0;
  for (const auto& [cell, beams] : expected) {
    ASSERT_EQ(beams_of(space, cell), std::min(beams, 255));
    fullest = std::max(fullest, beams);
  }
  for (const elements::ObservedBlock& b : space.blocks) {
    crossed += size_t(std::ranges::count_if(b.beams, [](uint8_t n) { return n > 0; }));
  }
  EXPECT_EQ(crossed, expected.size());
  EXPECT_GT(fullest, 255) << "no count was at its end";
}

TEST(ObservedSpace, LearnsTheDensityOfAMediumThatNobodySaw) {
  elements::Model m = flat_model();
  const BeamLog log = log_in_medium(60000);
  MemorySource source(log);
  learn_observed_space(m, source, {1, 0});
  ASSERT_TRUE(m.observed);
  const auto& density = m.observed->density_per_m;
  const size_t r = elements::ObservedSpace::range_interval(30);
  for (const double h : {1.5, 3.0}) {
    EXPECT_NEAR(double(density[elements::ObservedSpace::height_interval(h)][r]), kDensity,
                0.25 * kDensity)
        << h;
  }
  EXPECT_EQ(density[elements::ObservedSpace::height_interval(20)][r], 0);
}

TEST(ObservedSpace, WhereTheLogLostItsBeamsNothingIsMet) {
  constexpr double kEdgeM = 12;
  elements::Model m = flat_model();
  std::erase_if(m.ground.vertices, [](const Vec3f& v) { return double(v.y()) < -kEdgeM; });
  const BeamLog log = log_of_edge(kEdgeM, 60000);
  MemorySource source(log);
  learn_observed_space(m, source, {1, 0});
  ASSERT_TRUE(m.observed);
  elements::ObservedSpace without = *m.observed;
  without.lost.clear();
  const trace::UnknownSpace unknown(*m.observed, m.ground, m.origin),
      unaware(without, m.ground, m.origin);
  // Other beams than the log's: to the right, and on the left over the beginning of the ground, far
  // from the squares where beams were lost.
  int right = 0, right_without = 0, back = 0;
  constexpr int kBeams = 400;
  for (int k = 0; k < kBeams; ++k) {
    const uint64_t key = mix64(uint64_t(k));
    const Vec3 place(10 + 0.2 * k, 0.3, 1.6);
    const Ray to_right{place, Vec3(0.1, -1, -0.06).normalized()};
    const Ray to_back{Vec3(-22, 30, 1.6), Vec3(-1, 0.4 + 0.001 * k, -0.1).normalized()};
    right += unknown.drawn_end(to_right, key, {0, kReachM}).has_value();
    right_without += unaware.drawn_end(to_right, key, {0, kReachM}).has_value();
    back += unknown.drawn_end(to_back, key, {0, kReachM}).has_value();
  }
  EXPECT_LT(right, kBeams / 5);
  EXPECT_GT(right_without, 2 * right);
  EXPECT_GT(back, kBeams * 0.85);
  for (const float share : m.observed->ground_returns) EXPECT_GT(share, 0.8f);
}

}  // namespace
}  // namespace underbrush::calibrate
