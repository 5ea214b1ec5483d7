#include "studies/look_up.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace underbrush::studies {
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
  for (const LookUp how : {LookUp::kRaw, LookUp::kWarped1, LookUp::kWarped2}) {
    const Compared c = compared(log, looked_up(log, log, how));
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

TEST(LookUp, TakesTheScanWhoseSensorStoodNearest) {
  const BeamLog train = log_of({Vec3(-5, 0, 0), Vec3(3, 0, 0)}), test = log_of({Vec3(3.1, 0, 0)});
  EXPECT_LT(compared(test, looked_up(train, test, LookUp::kRaw)).worst_m, 0.5);
}

}  // namespace
}  // namespace underbrush::studies
