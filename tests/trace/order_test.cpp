#include "underbrush/trace/order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "underbrush/core/rng.hpp"

namespace underbrush::trace {
namespace {

void set_extremes(FloatRays& u, uint32_t rays) {
  const auto [low, high] = std::minmax_element(u.azimuth, u.azimuth + rays);
  const auto [lowest, highest] = std::minmax_element(u.sin_elevation, u.sin_elevation + rays);
  u.azimuth_low = *low;
  u.azimuth_high = *high;
  u.sin_elevation_low = *lowest;
  u.sin_elevation_high = *highest;
}

// Makes random beams in a tenth of the sphere, with `a_beam` rays within a milliradian each.
std::unique_ptr<FloatRays> beams(uint64_t seed, uint32_t rays, uint32_t a_beam) {
  Stream random(seed);
  auto u = std::make_unique<FloatRays>();
  float turn = 0, up = 0;
  for (uint32_t i = 0; i < rays; ++i) {
    if (i % a_beam == 0) {
      turn = float(random.uniform(-0.5, 0.5));
      up = float(random.uniform(-0.4, 0.4));
    }
    u->azimuth[i] = turn + float(random.uniform(-5e-4, 5e-4));
    u->sin_elevation[i] = up + float(random.uniform(-5e-4, 5e-4));
  }
  set_extremes(*u, rays);
  return u;
}

std::vector<uint32_t> order_of(const FloatRays& rays, uint32_t count) {
  std::vector<uint32_t> order(count, ~0u);
  order_by_direction(rays, order);
  return order;
}

TEST(Order, NamesEachRayOnce) {
  for (uint32_t a_beam : {1u, 2u, 9u, 16u, 41u, 8192u}) {
    for (uint32_t count : {2u, 63u, 1000u, uint32_t(kBatchRays)}) {
      std::vector<uint32_t> order = order_of(*beams(a_beam, count, a_beam), count);
      std::sort(order.begin(), order.end());
      for (uint32_t i = 0; i < count; ++i) ASSERT_EQ(order[i], i) << a_beam << " " << count;
    }
  }
}

// An order is kept for rays that point as those before did, and is made anew for others.
TEST(Order, ServesAgainWhereDirectionsRepeat) {
  constexpr uint32_t kRays = 4096;
  const auto rays = beams(1, kRays, 1);
  const auto order = std::make_unique<DirectionOrder>();
  const auto now = [&](uint32_t count) {
    const uint32_t* first = order->of(*rays, count);
    return std::vector<uint32_t>(first, first + count + kPacketRays);
  };
  const std::vector<uint32_t> made = now(kRays);
  EXPECT_TRUE(std::equal(made.end() - kPacketRays, made.end(),
                         std::vector<uint32_t>(kPacketRays, made[kRays - 1]).begin()));
  for (uint32_t i = 0; i < kRays; ++i) rays->azimuth[i] += i % 2 ? 1e-3f : -1e-3f;
  set_extremes(*rays, kRays);
  EXPECT_EQ(now(kRays), made);
  const auto [low, high] = std::minmax_element(rays->azimuth, rays->azimuth + kRays);
  std::swap(*low, *high);
  const std::vector<uint32_t> other = now(kRays);
  EXPECT_NE(other, made);
  EXPECT_EQ(std::vector<uint32_t>(other.begin(), other.begin() + kRays), order_of(*rays, kRays));
  std::vector<uint32_t> fewer = now(kRays / 2);
  std::sort(fewer.begin(), fewer.begin() + kRays / 2);
  for (uint32_t i = 0; i < kRays / 2; ++i) ASSERT_EQ(fewer[i], i);
  EXPECT_EQ(now(1), std::vector<uint32_t>(1 + kPacketRays, 0));
}

TEST(Order, KeepsTheRaysOfABeamTogether) {
  constexpr uint32_t kRays = kBatchRays, kABeam = 16;
  const std::vector<uint32_t> order = order_of(*beams(3, kRays, kABeam), kRays);
  for (uint32_t k = 0; k < kRays; ++k) EXPECT_EQ(order[k] % kABeam, k % kABeam);
}

// Each run of rays is a tile of the patch of the sphere, so that rays which point alike are traced
// together, in whatever order they come.
TEST(Order, MakesTilesAboutAsWideAsHigh) {
  constexpr uint32_t kRays = kBatchRays;
  const auto rays = beams(4, kRays, 1);
  const std::vector<uint32_t> order = order_of(*rays, kRays);
  double width = 0, height = 0;
  for (uint32_t tile = 0; tile < kRays; tile += kPacketRays) {
    float low[2] = {9, 9}, high[2] = {-9, -9};
    for (uint32_t k = tile; k < tile + kPacketRays; ++k) {
      const float at[2] = {rays->azimuth[order[k]], rays->sin_elevation[order[k]]};
      for (int a = 0; a < 2; ++a) {
        low[a] = std::min(low[a], at[a]);
        high[a] = std::max(high[a], at[a]);
      }
    }
    width += double(high[0] - low[0]) * M_PI / 2;
    height += double(high[1] - low[1]);
  }
  // 64 equal squares without gaps would share π/2 × 0.8.
  const double side = std::sqrt(M_PI / 2 * 0.8 / 64) * 64;
  EXPECT_LT(width, 1.4 * side);
  EXPECT_LT(height, 1.4 * side);
}

}  // namespace
}  // namespace underbrush::trace
