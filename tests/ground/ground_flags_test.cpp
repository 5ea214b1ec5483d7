#include "underbrush/ground/ground_flags.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::ground {
namespace {

// Makes gentle ground over 90 m with blobs 1 to 3 m above it, far from the origin; every 7th beam
// is a miss.
BeamLog site(std::vector<uint8_t>& truth) {
  Stream random(5);
  BeamLog log;
  log.resize(40000);
  for (size_t i = 0; i < log.size(); ++i) {
    if (i % 7 == 6) continue;
    const double x = random.uniform(-45, 45), y = random.uniform(-45, 45);
    const bool blob = int(std::floor(x / 3)) % 4 == 0 && int(std::floor(y / 3)) % 4 == 0;
    const double z = 0.1 * x + (blob ? random.uniform(1, 3) : 0);
    const Vec3 v(x, y, z - 10);
    log.origin[i] = Vec3(4e6, 5e6, 10);
    log.direction[i] = v.normalized().cast<float>();
    log.range_m[i] = float(v.norm());
    truth.push_back(!blob);
  }
  return log;
}

TEST(GroundFlags, OneAHitInTheLogsOrder) {
  std::vector<uint8_t> truth;
  const BeamLog log = site(truth);
  MemorySource source(log, 777);
  const std::vector<uint8_t> flags = ground_flags(source, {});
  ASSERT_EQ(flags.size(), truth.size());
  size_t same = 0;
  for (size_t i = 0; i < flags.size(); ++i) same += flags[i] == truth[i];
  EXPECT_GT(double(same) / double(flags.size()), 0.98);
}

TEST(GroundFlags, TilesChunksAndThreadsChangeLittleOrNothing) {
  std::vector<uint8_t> truth;
  const BeamLog log = site(truth);
  MemorySource whole(log), parts(log, 1001);
  const std::vector<uint8_t> flags = ground_flags(whole, {});
  set_threads(1);
  EXPECT_EQ(ground_flags(parts, {}), flags);
  set_threads(0);
  const std::vector<uint8_t> one_tile = ground_flags(whole, {}, 1000);
  size_t same = 0;
  for (size_t i = 0; i < flags.size(); ++i) same += flags[i] == one_tile[i];
  EXPECT_GT(double(same) / double(flags.size()), 0.99);
}

TEST(GroundFlags, OfALogWithoutHitsIsEmpty) {
  BeamLog log;
  log.resize(5);
  MemorySource source(log);
  EXPECT_TRUE(ground_flags(source, {}).empty());
}

}  // namespace
}  // namespace underbrush::ground
