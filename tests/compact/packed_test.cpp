#include "underbrush/compact/packed.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "logs.hpp"
#include "underbrush/compact/exact_math.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::compact {
namespace {

template <class T>
size_t packed_bytes(const std::vector<T>& values, const Order& order = {}) {
  Codec codec;
  std::string bytes;
  codec.pack<T>(values, order, bytes);
  std::vector<T> back(values.size());
  Cursor in(bytes, kFile, kPlace);
  codec.unpack<T>(in, order, back);
  EXPECT_EQ(back, values);
  EXPECT_THROW(in.require(1), FormatError);  // every byte was read
  return bytes.size();
}

template <class T>
class PackedOf : public testing::Test {};
using Types = testing::Types<uint8_t, uint16_t, uint32_t, uint64_t>;
TYPED_TEST_SUITE(PackedOf, Types);

TYPED_TEST(PackedOf, ComesBackWhateverTheValues) {
  using T = TypeParam;
  Stream random(11);
  for (const size_t n : {0, 1, 2, 3, 511, 513, 5000}) {
    std::vector<T> noise(n), steps(n), squares(n), few(n), extremes(n);
    for (size_t i = 0; i < n; ++i) {
      noise[i] = T(random.below(~T(0)) ^ (random.below(~T(0)) << 7));
      steps[i] = T(17 * i);
      squares[i] = T(i * i);
      few[i] = T(random.below(9) * (T(-1) / 9));
      extremes[i] = random.uniform() < 0.5 ? T(0) : T(~T(0));
    }
    Order order(n);
    std::iota(order.rbegin(), order.rend(), 0u);
    for (const auto& values : {noise, steps, squares, few, extremes}) {
      packed_bytes(values);
      packed_bytes(values, order);
    }
  }
}

TEST(Packed, RegularColumnsTakeNextToNothing) {
  std::vector<uint64_t> clock(65536), quadratic(65536);
  for (size_t i = 0; i < clock.size(); ++i) {
    clock[i] = 1'700'000'000'000 + 55'296 * i;
    quadratic[i] = 7 * i * i + 3 * i;
  }
  EXPECT_LT(packed_bytes(clock), 200u);
  EXPECT_LT(packed_bytes(quadratic), 200u);
}

// Two interleaved ramps are steps of one size only in the order of the rings.
TEST(Packed, TakesTheOrderThatCompressesBetter) {
  Stream random(3);
  std::vector<uint16_t> ring(65536);
  std::vector<uint32_t> values(ring.size());
  std::vector<uint32_t> next = {5, 1u << 30};
  for (size_t i = 0; i < ring.size(); ++i) {
    ring[i] = uint16_t(random.below(2));
    values[i] = next[ring[i]] += 1000;
  }
  EXPECT_LT(packed_bytes(values, order_by_ring(ring)), 500u);
  EXPECT_GT(packed_bytes(values), 5000u);
}

TEST(Packed, OrderByRingIsStableAndEmptyWhereNothingChanges) {
  EXPECT_TRUE(order_by_ring(std::vector<uint16_t>{0, 0, 1, 7}).empty());
  EXPECT_EQ(order_by_ring(std::vector<uint16_t>{2, 1, 2, 65535, 1}), (Order{1, 4, 0, 2, 3}));
}

// Bytes that were not written by `pack` are refused or give some values, and never more than asked.
TEST(Packed, DamageIsRefusedOrHarmless) {
  Stream random(5);
  Codec codec;
  std::vector<uint32_t> values(3000);
  for (size_t i = 0; i < values.size(); ++i) values[i] = uint32_t(random.below(50) * i);
  std::string whole;
  codec.pack<uint32_t>(values, {}, whole);
  size_t refused = 0;
  for (int k = 0; k < 3000; ++k) {
    std::string bytes = whole;
    bytes[size_t(random.below(k % 2 ? 40 : bytes.size()))] = char(random.below(256));
    if (k % 3 == 0) bytes.resize(size_t(random.below(bytes.size())));
    try {
      Cursor in(bytes, kFile, kPlace);
      codec.unpack<uint32_t>(in, {}, values);
    } catch (const FormatError& e) {
      EXPECT_EQ(e.place(), kPlace);
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000u);
}

TEST(ExactMath, SinesAreThoseOfTheLibrary) {
  Stream random(2);
  for (int k = 0; k < 100000; ++k) {
    const double x = random.uniform(-1, 1) * std::exp2(random.uniform(-30, 10));
    const SineCosine both = sine_cosine(x);
    ASSERT_NEAR(both.sine, std::sin(x), 4e-15) << x;
    ASSERT_NEAR(both.cosine, std::cos(x), 4e-15) << x;
  }
}

TEST(ExactMath, OrderedNumbersKeepOrderAndBits) {
  const float nan = std::bit_cast<float>(0xffc12345u);
  const std::vector<float> rising = {-INFINITY, -3.5f, -1e-40f, -0.0f, 0.0f, 1e-40f, 2, INFINITY};
  for (size_t i = 1; i < rising.size(); ++i) {
    EXPECT_LT(ordered(rising[i - 1]), ordered(rising[i]));
    EXPECT_LT(ordered(double(rising[i - 1])), ordered(double(rising[i])));
  }
  for (const float x : {nan, -0.0f, 0.0f, INFINITY, -7.25f}) {
    EXPECT_EQ(std::bit_cast<uint32_t>(from_ordered(ordered(x))), std::bit_cast<uint32_t>(x));
    EXPECT_EQ(std::bit_cast<uint64_t>(from_ordered(ordered(double(x)))),
              std::bit_cast<uint64_t>(double(x)));
  }
}

}  // namespace
}  // namespace underbrush::compact
