#include "underbrush/core/tile_store.hpp"

#include <gtest/gtest.h>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush {
namespace {

std::vector<TilePoint> random_points(uint64_t seed, int n, double extent) {
  Stream random(seed);
  std::vector<TilePoint> out;
  for (int i = 0; i < n; ++i) {
    const double x = random.uniform(-extent, extent), y = random.uniform(-extent, extent);
    out.push_back({Vec3f(float(x), float(y), float(i)), Vec3f::UnitZ()});
  }
  return out;
}

std::vector<float> ids(const TileStore::Loaded& loaded, size_t begin, size_t end) {
  std::vector<float> out;
  for (size_t i = begin; i < end; ++i) out.push_back(loaded.point[i].z());
  return out;
}

TEST(TileStore, GivesEachPointOnceAsCoreInOrder) {
  const auto points = random_points(1, 5000, 90);
  TileStore store;
  for (const TilePoint& p : points) store.add(p);
  size_t total = 0;
  for (const TileKey key : store.tiles()) {
    const auto loaded = store.load(key, 0);
    EXPECT_EQ(loaded.core, loaded.point.size());
    const auto z = ids(loaded, 0, loaded.core);
    EXPECT_TRUE(std::is_sorted(z.begin(), z.end()));
    const Eigen::Vector2d c = store.corner(key);
    for (const Vec3f& p : loaded.point) {
      EXPECT_TRUE(p.x() >= c.x() && p.x() < c.x() + 32);
      EXPECT_TRUE(p.y() >= c.y() && p.y() < c.y() + 32);
    }
    total += loaded.core;
  }
  EXPECT_EQ(total, points.size());
  EXPECT_EQ(store.thinned(), 0u);
}

TEST(TileStore, MarginHoldsAllPointsWithinIt) {
  const auto points = random_points(2, 5000, 90);
  TileStore store;
  for (const TilePoint& p : points) store.add(p);
  const auto loaded = store.load({0, 0}, 40);  // wider than a tile
  size_t expected = 0;
  for (const TilePoint& p : points) {
    expected += p.point.x() >= -40 && p.point.x() < 72 && p.point.y() >= -40 && p.point.y() < 72;
  }
  EXPECT_EQ(loaded.point.size(), expected);
}

TEST(TileStore, GivesTheSameFromDiskAsFromMemoryEvenWhenThinned) {
  const auto points = random_points(3, 20000, 30);
  TileOptions roomy, tight;
  roomy.max_points_per_tile = tight.max_points_per_tile = 1500;
  tight.memory_bytes = 20000;
  TileStore a(roomy), b(tight);
  for (const TilePoint& p : points) {
    a.add(p);
    b.add(p);
  }
  ASSERT_EQ(a.tiles(), b.tiles());
  EXPECT_GT(a.thinned(), 0u);
  EXPECT_EQ(a.thinned(), b.thinned());
  for (const TileKey key : a.tiles()) {
    const auto x = a.load(key, 5), y = b.load(key, 5);
    EXPECT_LE(x.core, 1500u);
    EXPECT_GT(x.core, 500u);
    EXPECT_EQ(x.core, y.core);
    EXPECT_EQ(ids(x, 0, x.point.size()), ids(y, 0, y.point.size()));
  }
}

TEST(TileStore, SaysSoWhereItCannotSpill) {
  TileOptions options;
  options.memory_bytes = 100;
  options.spill_folder = "/proc/nowhere";
  TileStore store(options);
  EXPECT_THROW(for (const TilePoint& p : random_points(4, 100, 5)) store.add(p), IoError);
}

}  // namespace
}  // namespace underbrush
