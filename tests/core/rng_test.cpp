#include "underbrush/core/rng.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace underbrush {
namespace {

TEST(Normal, InvertsTheNormalDistribution) {
  for (double x = -8; x <= 8; x += 0.01) {
    const double tail = 0.5 * std::erfc(std::abs(x) / std::sqrt(2.0));
    if (tail < 1e-15) continue;
    // In the lower tail u is exact; the upper tail is its mirror image.
    EXPECT_NEAR(normal_from_uniform(tail), -std::abs(x), 1e-12 * (1 + std::abs(x))) << x;
  }
  EXPECT_EQ(normal_from_uniform(0.5), 0.0);
}

// The accept bits pass a χ² test in 256 cells over (beam, element) pairs. Weak hashes fail for such
// keys and elements of low entropy.
TEST(AcceptBits, AreUniformOverNeighbouringBeamsAndElements) {
  for (int shift : {0, 8, 16, 24}) {
    std::vector<double> cell(256);
    const int n = 1 << 20;
    for (int i = 0; i < n; ++i) {
      ++cell[(accept_bits(beam_key(7, 0, uint64_t(i >> 5)), uint32_t(i & 31)) >> shift) & 255];
    }
    double chi2 = 0;
    for (double c : cell) chi2 += (c - n / 256.0) * (c - n / 256.0) / (n / 256.0);
    EXPECT_LT(chi2, 255 + 5 * std::sqrt(2 * 255.0)) << "bits from " << shift;
  }
}

TEST(AcceptBits, OfTwoElementsAreIndependent) {
  std::vector<double> cell(256);
  const int n = 1 << 20;
  for (int i = 0; i < n; ++i) {
    const uint64_t key = beam_key(3, 1, uint64_t(i));
    ++cell[(accept_bits(key, 10) >> 28) << 4 | accept_bits(key, 11) >> 28];
  }
  double chi2 = 0;
  for (double c : cell) chi2 += (c - n / 256.0) * (c - n / 256.0) / (n / 256.0);
  EXPECT_LT(chi2, 255 + 5 * std::sqrt(2 * 255.0));
}

TEST(RandomBits, DifferByPurposeSeedScanAndBeam) {
  const uint64_t key = beam_key(1, 2, 3);
  EXPECT_NE(random_bits(key, 4, Purpose::kRange), random_bits(key, 4, Purpose::kNoise));
  EXPECT_NE(key, beam_key(2, 2, 3));
  EXPECT_NE(key, beam_key(1, 3, 3));
  EXPECT_NE(key, beam_key(1, 2, 4));
}

TEST(QuickNormal, IsTheExactOneButForTwoTenThousandths) {
  const QuickNormal quick;
  Stream random(12);
  for (int i = 0; i < 400000; ++i) {
    const uint64_t bits = random.bits();
    ASSERT_NEAR(quick(bits), normal_from_uniform(uniform_from_bits(bits)), 2e-4) << bits;
  }
  for (const uint64_t bits :
       {uint64_t(0), ~uint64_t(0), uint64_t(16) << 52, uint64_t(4080) << 52}) {
    EXPECT_NEAR(quick(bits), normal_from_uniform(uniform_from_bits(bits)), 2e-4) << bits;
  }
}

TEST(Stream, HasTheMomentsOfItsDistributions) {
  Stream random(11);
  double mean = 0, square = 0;
  const int n = 400000;
  for (int i = 0; i < n; ++i) {
    const double x = random.normal();
    mean += x / n;
    square += x * x / n;
  }
  EXPECT_NEAR(mean, 0, 5 / std::sqrt(n));
  EXPECT_NEAR(square, 1, 5 * std::sqrt(2.0 / n));
}

}  // namespace
}  // namespace underbrush
