// This file makes random logs for the tests of log files, and compares logs.
#pragma once
#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::io {

inline const char* const kProvenance =
    R"({"command":["time","intensity"],"when\time":"\"intensity\""})";

inline BeamLog random_log(uint64_t seed, size_t n, double far, bool colours = false) {
  Stream random(seed);
  BeamLog log;
  log.info.sensor = "lifetime-intensity";
  log.info.max_range_m = 120;
  log.info.min_range_m = 0.9;
  log.info.has_misses = true;
  log.info.deskewed = true;
  for (uint32_t s = 0; s < 3; ++s) {
    Eigen::Quaterniond q(random.normal(), 0, 0, 0);
    q.x() = random.normal(), q.y() = random.normal(), q.z() = random.normal();
    log.info.scans.push_back({10 + s, 1.3e9 + 0.1 * s, {q.normalized(), Vec3(far, s, -0.1)}});
  }
  log.extra["class"] = std::vector<uint16_t>{};
  log.extra["small"] = std::vector<int8_t>{};
  log.extra["intensity of time"] = std::vector<int16_t>{};
  log.extra["xray"] = std::vector<double>{};
  log.extra["ring"] = std::vector<float>{};
  if (colours) {
    for (const char* c : {"red", "green", "blue"}) log.extra[c] = std::vector<uint8_t>{};
  }
  log.resize(n);
  for (size_t i = 0; i < n; ++i) {
    Vec3 d;
    for (int c = 0; c < 3; ++c) log.origin[i][c] = far + random.normal(), d[c] = random.normal();
    log.direction[i] = d.normalized().cast<float>();
    log.range_m[i] = random.uniform() < 0.2 ? kMiss : float(std::exp2(random.uniform(-8, 10)));
    // The grid of ranges changes at powers of two.
    if (i % 16 == 0) log.range_m[i] = std::nextafter(float(1 << (i / 16 % 9)), i % 32 ? 0.f : 1e9f);
    log.intensity[i] = log.is_hit(i) ? float(random.uniform()) : 0.f;
    log.time_s[i] = 1.3e9 + random.uniform();
    log.ring[i] = uint16_t(i % 64);
    log.scan[i] = uint32_t(10 + i % 3);
    log.packet[i] = uint32_t(i / 7);
    log.flags[i] = uint8_t(i % 2);
    for (auto& [name, column] : log.extra) {
      std::visit([&](auto& c) { c[i] = std::decay_t<decltype(c[0])>(random.below(120)); }, column);
    }
  }
  return log;
}

inline void expect_same(const BeamLog& a, const BeamLog& b) {
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_EQ(a.range_m, b.range_m);
  EXPECT_EQ(a.intensity, b.intensity);
  EXPECT_EQ(a.time_s, b.time_s);
  EXPECT_EQ(a.ring, b.ring);
  EXPECT_EQ(a.scan, b.scan);
  EXPECT_EQ(a.packet, b.packet);
  EXPECT_EQ(a.flags, b.flags);
  EXPECT_EQ(a.extra, b.extra);
  EXPECT_EQ(a.info.sensor, b.info.sensor);
  EXPECT_EQ(a.info.min_range_m, b.info.min_range_m);
  EXPECT_EQ(a.info.max_range_m, b.info.max_range_m);
  EXPECT_EQ(a.info.has_misses, b.info.has_misses);
  EXPECT_EQ(a.info.deskewed, b.info.deskewed);
  ASSERT_EQ(a.info.scans.size(), b.info.scans.size());
  for (size_t s = 0; s < a.info.scans.size(); ++s) {
    EXPECT_EQ(a.info.scans[s].scan, b.info.scans[s].scan);
    EXPECT_EQ(a.info.scans[s].time_s, b.info.scans[s].time_s);
    EXPECT_EQ(a.info.scans[s].world_from_sensor.translation,
              b.info.scans[s].world_from_sensor.translation);
    EXPECT_EQ(a.info.scans[s].world_from_sensor.rotation.coeffs(),
              b.info.scans[s].world_from_sensor.rotation.coeffs());
  }
}

}  // namespace underbrush::io
