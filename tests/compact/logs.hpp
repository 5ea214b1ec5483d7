/// \file
/// Logs for the tests of the compact log.
#pragma once
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::compact {

/// What errors of a cursor name.
inline const std::string kFile = "file", kPlace = "place";

/// Rows without any pattern, with an extra column of each type.
inline BeamLog random_log(uint64_t seed, size_t n, bool extra = true) {
  Stream random(seed);
  BeamLog log;
  if (extra) {
    log.extra = {{"a", std::vector<uint8_t>()},  {"b", std::vector<uint16_t>()},
                 {"c", std::vector<uint32_t>()}, {"d", std::vector<int8_t>()},
                 {"e", std::vector<int16_t>()},  {"f", std::vector<int32_t>()},
                 {"g", std::vector<float>()},    {"h", std::vector<double>()}};
  }
  log.resize(n);
  for (size_t i = 0; i < n; ++i) {
    const Vec3 d(random.normal(), random.normal(), random.normal());
    log.direction[i] = d.normalized().cast<float>();
    for (double& x : log.origin[i]) x = 1000 * random.normal();
    log.range_m[i] = random.uniform() < 0.3 ? kMiss : float(std::exp2(random.uniform(-8, 10)));
    log.intensity[i] = log.is_hit(i) ? float(random.normal()) : 0.0f;
    log.time_s[i] = random.uniform(0, 100);
    log.ring[i] = uint16_t(random.below(5));
    log.scan[i] = uint32_t(random.below(3));
    log.packet[i] = uint32_t(random.below(1u << 31));
    log.flags[i] = uint8_t(random.below(4));
    for (auto& [name, column] : log.extra) {
      std::visit([&](auto& c) { c[i] = std::decay_t<decltype(c[0])>(random.below(90)); }, column);
    }
  }
  return log;
}

/// A sensor of 32 rings on a car that drives and turns, fired column by column (or ring by ring),
/// whose rows have the bits of the sensor module's pattern: poses by `Trajectory::at`. A `still`
/// one stands.
inline BeamLog scanned_log(size_t n, bool ring_by_ring = false, bool still = false) {
  constexpr size_t kRings = 32, kColumns = 1000;
  Stream random(9);
  BeamLog log;
  std::vector<StampedPose> poses;
  for (uint32_t s = 0; s < n / (kRings * kColumns) + 2; ++s) {
    const double moved = still ? 0 : s;
    const Eigen::AngleAxisd turn(0.02 * moved, Vec3(0.1, 0.2, 1).normalized());
    const Pose pose{Eigen::Quaterniond(turn), Vec3(100 + 1.1 * moved, -3 + 0.2 * moved, 1.7)};
    poses.push_back({5 + 0.1 * s, pose});
    log.info.scans.push_back({s, 5 + 0.1 * s, pose});
  }
  const Trajectory track(poses);
  log.resize(n);
  for (size_t i = 0; i < n; ++i) {
    const size_t turn = i / (kRings * kColumns), at = i % (kRings * kColumns);
    const size_t ring = ring_by_ring ? at / kColumns : at % kRings;
    const size_t column = ring_by_ring ? at % kColumns : at / kRings;
    log.time_s[i] = 5 + 0.1 * double(turn) + 1e-4 * double(column);
    const Pose pose = *track.at(log.time_s[i]);
    const double azimuth = -2 * M_PI * double(column) / kColumns, elevation = 0.01 * double(ring);
    const Vec3 d(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                 std::sin(elevation));
    log.direction[i] = (pose.rotation * d).cast<float>();
    log.origin[i] = pose.translation;
    log.ring[i] = uint16_t(ring);
    log.scan[i] = uint32_t(turn);
    log.packet[i] = uint32_t(column / 12);
    const bool hit = random.uniform() < 0.7;
    log.range_m[i] = hit ? float(12 + 5 * std::sin(3 * azimuth) + 0.02 * random.normal()) : kMiss;
    log.intensity[i] = hit ? float(random.below(100)) / 100 : 0.0f;
  }
  return log;
}

template <class Column>
bool same_bits(const Column& a, const Column& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

/// Fails the test unless every bit of every column is the same.
inline void expect_same_bits(const BeamLog& a, const BeamLog& b) {
  EXPECT_TRUE(same_bits(a.origin, b.origin));
  EXPECT_TRUE(same_bits(a.direction, b.direction));
  EXPECT_TRUE(same_bits(a.range_m, b.range_m));
  EXPECT_TRUE(same_bits(a.intensity, b.intensity));
  EXPECT_TRUE(same_bits(a.time_s, b.time_s));
  EXPECT_TRUE(same_bits(a.ring, b.ring));
  EXPECT_TRUE(same_bits(a.scan, b.scan));
  EXPECT_TRUE(same_bits(a.packet, b.packet));
  EXPECT_TRUE(same_bits(a.flags, b.flags));
  ASSERT_EQ(a.extra.size(), b.extra.size());
  for (const auto& [name, column] : a.extra) {
    std::visit(
        [&, key = name](const auto& c) {
          EXPECT_TRUE(same_bits(c, std::get<std::decay_t<decltype(c)>>(b.extra.at(key)))) << key;
        },
        column);
  }
}

}  // namespace underbrush::compact
