#include "underbrush/metrics/bearing_range.hpp"

#include <gtest/gtest.h>

#include "underbrush/core/rng.hpp"

namespace underbrush::metrics {
namespace {

constexpr double kStep = 2 * M_PI / 4000;

/// Makes beams of one laser at a bearing, with the given ranges.
BeamLog beams_at(int bearing, const std::vector<float>& ranges, uint16_t ring = 0) {
  BeamLog log;
  log.info.has_misses = true;
  log.resize(ranges.size());
  for (size_t i = 0; i < ranges.size(); ++i) {
    const double a = bearing * kStep;
    log.direction[i] = Vec3(std::cos(a), std::sin(a), 0).cast<float>();
    log.range_m[i] = ranges[i];
    log.ring[i] = ring;
  }
  return log;
}

BearingRangeHistogram histogram(const std::vector<BeamLog>& logs) {
  BearingRangeHistogram h;
  for (const BeamLog& log : logs) h.add(log);
  return h;
}

/// Makes `n` ranges of N(mean, sigma) from quantiles, without sampling error.
std::vector<float> gaussian(double mean, double sigma, int n) {
  std::vector<float> out(size_t(n), 0);
  for (int k = 0; k < n; ++k) {
    out[size_t(k)] = float(mean + sigma * normal_from_uniform((k + 0.5) / n));
  }
  return out;
}

TEST(BearingRange, EqualHistogramsAreAtDistanceZero) {
  const auto a = histogram({beams_at(-3, {8, 8.1f, 8.1f, kMiss}), beams_at(5, {7, kMiss}, 2)});
  const auto twice = histogram({beams_at(-3, {8, 8.1f, 8.1f, kMiss, 8, 8.1f, 8.1f, kMiss}),
                                beams_at(5, {7, kMiss, 7, kMiss}, 2)});
  EXPECT_NEAR(bhattacharyya_distance(a, a), 0, 1e-12);
  EXPECT_NEAR(bhattacharyya_distance(a, twice), 0, 1e-12);
}

TEST(BearingRange, IsSymmetricAndKnowsLaserBearingAndRange) {
  const auto a = histogram({beams_at(0, {8, 8, 9, kMiss})});
  const auto b = histogram({beams_at(0, {8, 9, 9.5f, 9.5f})});
  EXPECT_DOUBLE_EQ(bhattacharyya_distance(a, b), bhattacharyya_distance(b, a));
  EXPECT_NEAR(bhattacharyya_coefficient(a, b), std::sqrt(0.5 * 0.25) + 0.25, 1e-12);
  for (const auto& other : {beams_at(1, {8, 9}), beams_at(0, {8, 9}, 1), beams_at(0, {8.5f})}) {
    EXPECT_EQ(bhattacharyya_coefficient(a, histogram({other})), 0);
    EXPECT_EQ(bhattacharyya_distance(a, histogram({other})), INFINITY);
  }
}

TEST(BearingRange, TwoGaussiansHaveTheirClosedForm) {
  // The distance is D = ¼ (μ₁−μ₂)² / (σ₁²+σ₂²) + ½ ln((σ₁²+σ₂²) / (2 σ₁σ₂)) for bins much narrower
  // than σ.
  for (const auto& [m, s, t] :
       {std::array{0.0, 0.02, 0.03}, {0.05, 0.02, 0.02}, {0.03, 0.02, 0.05}}) {
    const auto a = histogram({beams_at(0, gaussian(8, s, 200000))});
    const auto b = histogram({beams_at(0, gaussian(8 + m, t, 200000))});
    const double v = s * s + t * t;
    EXPECT_NEAR(bhattacharyya_distance(a, b), m * m / v / 4 + std::log(v / (2 * s * t)) / 2, 1e-3);
  }
}

TEST(BearingRange, BeamsWithoutAReturnCount) {
  const auto half = histogram({beams_at(0, {8, kMiss})});
  const auto none = histogram({beams_at(0, {kMiss, kMiss})});
  const auto all = histogram({beams_at(0, {8, 8})});
  EXPECT_NEAR(bhattacharyya_coefficient(half, none), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(bhattacharyya_coefficient(half, all), std::sqrt(0.5), 1e-12);
  EXPECT_EQ(bhattacharyya_coefficient(none, all), 0);
}

TEST(BearingRange, TheWholeIsTheMeanOfItsDirections) {
  Stream random(11);
  std::vector<BeamLog> first, second;
  for (int d = 0; d < 6; ++d) {
    std::vector<float> r[2];
    for (int k = 0; k < 300; ++k) {
      for (auto& ranges : r) ranges.push_back(float(8 + 0.002 * double(random.below(20))));
    }
    first.push_back(beams_at(d - 3, r[0], uint16_t(d % 2)));
    second.push_back(beams_at(d - 3, r[1], uint16_t(d % 2)));
  }
  const auto a = histogram(first), b = histogram(second);
  double mean = 0;
  const std::vector<DirectionOverlap> overlaps = direction_overlaps(a, b);
  ASSERT_EQ(overlaps.size(), 6u);
  for (const DirectionOverlap& o : overlaps) mean += o.coefficient / 6;
  EXPECT_NEAR(bhattacharyya_coefficient(a, b), mean, 1e-9);
  EXPECT_LT(mean, 1);
}

TEST(BearingRange, BinsAreTheEncodersAndTheRangeCounts) {
  BearingRangeHistogram h;
  h.add(beams_at(-1, {8.001f, 8.0015f, 8.003f}));
  h.add(beams_at(-1, {8.001f}));
  ASSERT_EQ(h.occupied().size(), 2u);
  EXPECT_EQ(h.occupied()[0].bearing, 3999);
  EXPECT_EQ(h.occupied()[0].range, 4000u);
  EXPECT_EQ(h.occupied()[0].count, 3u);
  EXPECT_EQ(h.occupied()[1].range, 4001u);
  EXPECT_EQ(h.total(), 4u);
}

TEST(BearingRange, BearingsAreThoseOfTheSensorsFrame) {
  Pose turned;
  turned.rotation = Eigen::AngleAxisd(10 * kStep, Vec3::UnitZ());
  BearingRangeHistogram h({}, turned);
  h.add(beams_at(17, {8}));
  EXPECT_EQ(h.occupied().at(0).bearing, 7);
}

TEST(BearingRange, RefusesBinsThatAreNone) {
  EXPECT_THROW(BearingRangeHistogram({0, 0.002}), std::invalid_argument);
  EXPECT_THROW(BearingRangeHistogram({1e-6, 0.002}), std::invalid_argument);
  const auto a = histogram({beams_at(0, {8})});
  EXPECT_THROW(bhattacharyya_distance(a, BearingRangeHistogram({kStep, 0.01})),
               std::invalid_argument);
  EXPECT_THROW(bhattacharyya_distance(a, BearingRangeHistogram()), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::metrics
