#include "underbrush/sensor/organised_scan.hpp"

#include <gtest/gtest.h>

#include "underbrush/core/rng.hpp"
#include "underbrush/sensor/angles.hpp"
#include "underbrush/sensor/beams_from_scan.hpp"

namespace underbrush::sensor {
namespace {

/// A motion-compensated scan of a scanner that turns and moves, and the true directions of its
/// misses.
struct MovedScan {
  PointScan scan;
  std::vector<Vec3> direction;  // one a point, in the points' frame
  size_t misses = 0;
};

struct Motion {
  Vec3 turn_rad = Vec3::Zero();  // by the end of the scan; it grows with the square of time
  Vec3 move_m = Vec3::Zero();    // by the end of the scan
  Vec3 tilt_rad = Vec3::Zero();  // of the points' frame
};

Eigen::Quaterniond turned(const Vec3& v) {
  const double angle = v.norm();
  return angle > 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, v / angle))
                   : Eigen::Quaterniond::Identity();
}

MovedScan moved_scan(const Motion& motion, bool rings, size_t rows = 64, size_t columns = 512) {
  MovedScan out;
  for (size_t r = 0; r < rows; ++r) {
    for (size_t c = 0; c < columns; ++c) {
      const double u = (double(c) + 0.5) / double(columns);
      const Vec3 fired = unit_vector(-2 * M_PI * double(c) / double(columns) + 0.01 * double(r % 4),
                                     (22.5 - 45.0 * double(r) / double(rows)) * kDegree);
      const Eigen::Quaterniond rotation = turned(motion.tilt_rad) * turned(motion.turn_rad * u * u);
      const double chance =
          uniform_from_bits(random_bits(7, uint32_t(r * columns + c), Purpose::kPlace));
      const double range = 4 + 40 * uniform_from_bits(random_bits(
                                        8, uint32_t((r / 4) * columns + c / 8), Purpose::kPlace));
      const bool miss = chance < 0.3;
      out.misses += miss;
      out.direction.push_back(rotation * fired);
      out.scan.point.push_back(
          miss ? Vec3f::Zero()
               : Vec3f((rotation * (range * fired) + motion.move_m * u).cast<float>()));
      if (rings) out.scan.ring.push_back(uint16_t(r));
    }
  }
  out.scan.intensity.resize(out.scan.size());
  return out;
}

// Returns the largest angle between the directions found for the misses and the true ones.
double worst_angle(const MovedScan& moved) {
  const auto grid = find_organised_scan(moved.scan, nullptr);
  if (!grid) return INFINITY;
  double worst = 0;
  for (size_t i = 0; i < moved.scan.size(); ++i) {
    if (!moved.scan.point[i].isZero(0)) continue;
    const Angles found = grid->direction(i);
    const Vec3 d = unit_vector(found.azimuth_rad, found.elevation_rad);
    worst = std::max(worst, d.cross(moved.direction[i]).norm());
  }
  return worst;
}

TEST(OrganisedScan, OfAScannerAtRestNeedsNoMotion) {
  const MovedScan still = moved_scan({}, false);
  const auto grid = find_organised_scan(still.scan, nullptr);
  ASSERT_TRUE(grid);
  EXPECT_FALSE(grid->motion);
  EXPECT_LT(worst_angle(still), 1e-5);
}

TEST(OrganisedScan, KeepsItsMissesUnderMotionCompensation) {
  const Motion motions[] = {
      {.turn_rad = Vec3(0.3, 0, 0) * kDegree},
      {.turn_rad = Vec3(0.5, 0.2, 0) * kDegree},
      {.turn_rad = Vec3(2, -1, 3) * kDegree},
      {.turn_rad = Vec3(0, 0, 10) * kDegree},
      {.move_m = Vec3(1.5, 0, 0.05)},
      {.turn_rad = Vec3(0.5, 1, 4) * kDegree, .move_m = Vec3(1, 0.1, 0)},
      {.tilt_rad = Vec3(2, 1, 0) * kDegree},
      {.turn_rad = Vec3(0.5, 1, 4) * kDegree,
       .move_m = Vec3(1, 0, 0),
       .tilt_rad = Vec3(1, 2, 0) * kDegree},
  };
  for (const Motion& motion : motions) {
    for (const bool rings : {false, true}) {
      const MovedScan moved = moved_scan(motion, rings);
      EXPECT_LT(worst_angle(moved), 0.1 * kDegree)
          << "turn " << motion.turn_rad.transpose() / kDegree << ", move "
          << motion.move_m.transpose() << ", tilt " << motion.tilt_rad.transpose() / kDegree;
      BeamCounts counts;
      beams_from_scan(moved.scan, Trajectory(), {}, counts);
      EXPECT_EQ(counts.misses_recorded, moved.misses);
      EXPECT_TRUE(counts.skipped.empty());
    }
  }
}

TEST(OrganisedScan, IsNotFoundInPointsWithoutOne) {
  MovedScan moved = moved_scan({}, false);
  for (size_t i = 0; i < moved.scan.size(); ++i) {
    const size_t other = random_bits(9, uint32_t(i), Purpose::kPlace) % moved.scan.size();
    std::swap(moved.scan.point[i], moved.scan.point[other]);
  }
  EXPECT_FALSE(find_organised_scan(moved.scan, nullptr));
}

}  // namespace
}  // namespace underbrush::sensor
