#include "underbrush/metrics/look_up.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace underbrush::metrics {
namespace {

/// Makes a scan of a wall at x = 10 m from `origin`: 16 rings of 400 beams, of which those that
/// point away from the wall miss.
void add_scan(BeamLog& log, uint32_t scan, const Vec3& origin, double time_s) {
  for (int k = 0; k < 400; ++k) {
    for (int ring = 0; ring < 16; ++ring) {
      const double azimuth = 2 * M_PI * k / 400, elevation = 0.02 * (ring - 7.5);
      const Vec3 d(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
                   std::sin(elevation));
      const size_t i = log.size();
      log.resize(i + 1);
      log.origin[i] = origin;
      log.direction[i] = d.cast<float>();
      log.ring[i] = uint16_t(ring);
      log.scan[i] = scan;
      log.time_s[i] = time_s;
      const double t = (10 - origin.x()) / d.x();
      log.range_m[i] = d.x() > 0.3 ? float(t) : kMiss;
    }
  }
  log.info.scans.push_back({scan, time_s, {Eigen::Quaterniond::Identity(), origin}});
}

BeamLog log_of(const std::vector<Vec3>& origins) {
  BeamLog log;
  log.info.max_range_m = 100;
  for (size_t k = 0; k < origins.size(); ++k) {
    add_scan(log, uint32_t(k), origins[k], 0.1 * double(k));
  }
  return log;
}

struct Compared {
  double worst_m = 0;
  size_t wrong = 0, hits = 0;
};
Compared compared(const BeamLog& real, const BeamLog& answered) {
  Compared c;
  EXPECT_EQ(real.size(), answered.size());
  for (size_t i = 0; i < real.size(); ++i) {
    if (real.is_hit(i) != answered.is_hit(i)) {
      ++c.wrong;
    } else if (real.is_hit(i)) {
      ++c.hits;
      c.worst_m = std::max(c.worst_m, std::abs(double(real.range_m[i] - answered.range_m[i])));
    }
  }
  return c;
}

TEST(LookUp, FindsTheSameScanAgain) {
  const BeamLog log = log_of({Vec3::Zero()});
  for (const LookUp kind : {LookUp::kRaw, LookUp::kWarped1, LookUp::kWarped2}) {
    const Compared c = compared(log, looked_up(log, log, kind));
    EXPECT_EQ(c.wrong, 0u);
    EXPECT_GT(c.hits, 1000u);
    EXPECT_LT(c.worst_m, 1e-5);
  }
}

TEST(LookUp, WarpedPointsFollowTheSensorAndRawRangesDoNot) {
  const BeamLog train = log_of({Vec3(0, 0, 0)}), test = log_of({Vec3(1, 0, 0)});
  const Compared raw = compared(test, looked_up(train, test, LookUp::kRaw));
  const Compared warped = compared(test, looked_up(train, test, LookUp::kWarped1));
  EXPECT_GT(raw.worst_m, 0.9);  // the wall is 1 m nearer
  EXPECT_LT(warped.worst_m, 0.6);
  double sum = 0;
  const BeamLog answered = looked_up(train, test, LookUp::kWarped1);
  for (size_t i = 0; i < test.size(); ++i) {
    if (test.is_hit(i) && answered.is_hit(i)) {
      sum += std::abs(double(test.range_m[i] - answered.range_m[i])) / double(warped.hits);
    }
  }
  EXPECT_LT(sum, 0.1);
}

TEST(LookUp, SeesThePointsFromEachBeamsOwnOrigin) {
  // The sensor moves by 2 m along the wall within a scan; training and test have the same origins.
  // From one place for all beams, points would be looked for up to 1 m beside where they are.
  BeamLog log = log_of({Vec3::Zero()});
  for (size_t i = 0; i < log.size(); ++i) {
    log.origin[i].y() = 2 * double(i) / double(log.size()) - 1;
    if (!log.is_hit(i)) continue;
    // A picket fence before the wall: each half metre of it lies 2 m nearer.
    const double slope = double(log.direction[i].y()) / double(log.direction[i].x());
    const bool picket = std::fmod(log.origin[i].y() + 8 * slope + 100, 1) < 0.5;
    log.range_m[i] = float((picket ? 8 : 10) / double(log.direction[i].x()));
  }
  const Compared c = compared(log, looked_up(log, log, LookUp::kWarped1));
  EXPECT_EQ(c.wrong, 0u);
  EXPECT_GT(c.hits, 1000u);
  // Where the turn closes, a beam has a neighbour that was fired from 2 m away.
  EXPECT_LT(c.worst_m, 0.01);
}

/// Beams about +x: (azimuth, range), of one ring.
BeamLog pencil(const std::vector<std::pair<double, float>>& beams) {
  BeamLog log;
  log.info.max_range_m = 100;
  for (const auto& [azimuth, range] : beams) {
    const size_t i = log.size();
    log.resize(i + 1);
    log.direction[i] = Vec3f(float(std::cos(azimuth)), float(std::sin(azimuth)), 0);
    log.range_m[i] = range;
  }
  return log;
}

TEST(LookUp, TakesTheNearestInAngleAndInRangeOnlyWithinHalfABeam) {
  // Beams are 10 mrad apart, so half a beam is 5 mrad.
  const BeamLog test = pencil({{0, 50}, {0.01, 50}, {0.02, 50}});
  const auto answers = [&](const std::vector<std::pair<double, float>>& train) {
    return looked_up(pencil(train), test, LookUp::kWarped1).range_m[1];
  };
  EXPECT_EQ(answers({{0.011, 20}, {0.018, 8}}), 20)
      << "the nearer one is more than half a beam away";
  EXPECT_EQ(answers({{0.011, 20}, {0.013, 8}}), 8) << "both are within half a beam";
  EXPECT_EQ(answers({{0.017, 20}, {0.019, 8}}), 20) << "none is within half a beam";
}

TEST(LookUp, MissesKeepTheirDirectionAndAnswerWithAMiss) {
  const BeamLog test = pencil({{0, 50}, {0.01, 50}, {0.02, 50}});
  const auto answers = [&](const std::vector<std::pair<double, float>>& train) {
    return looked_up(pencil(train), test, LookUp::kWarped1).range_m[1];
  };
  EXPECT_EQ(answers({{0.011, kMiss}, {0.018, 8}}), kMiss);
  EXPECT_EQ(answers({{0.011, kMiss}, {0.012, 8}}), 8) << "a point within half a beam goes first";
  EXPECT_EQ(answers({{0.017, kMiss}, {0.019, 8}}), kMiss);
  BeamLog moved = test;
  for (Vec3& origin : moved.origin) origin.y() = 5;
  const BeamLog train = pencil({{0.011, kMiss}});
  EXPECT_EQ(looked_up(train, moved, LookUp::kWarped1).range_m[1], kMiss);
}

TEST(LookUp, TakesTheScanWhoseSensorStoodNearest) {
  const BeamLog train = log_of({Vec3(-5, 0, 0), Vec3(3, 0, 0)}), test = log_of({Vec3(3.1, 0, 0)});
  EXPECT_LT(compared(test, looked_up(train, test, LookUp::kRaw)).worst_m, 0.5);
}

}  // namespace
}  // namespace underbrush::metrics
