// Walls, of which the thickness and the space between the beams are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "underbrush/core/linear.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/fit/fit.hpp"
#include "underbrush/simulate/simulate.hpp"

namespace underbrush::fit {
namespace {

/// A scan of a wall at y = 10 m from the origin with the given noise of the range (m), in which
/// each of `directions` beams is fired `repeats` times.
BeamLog scan_of_a_wall(int directions, int repeats, double noise_m) {
  Stream random(13);
  BeamLog log;
  log.info.has_misses = true;
  log.resize(size_t(directions) * size_t(repeats));
  for (int d = 0; d < directions; ++d) {
    const Vec3 to(random.uniform(-4, 4), 10, random.uniform(0.5, 4));
    for (size_t i = size_t(d) * repeats; i < size_t(d + 1) * repeats; ++i) {
      log.direction[i] = to.normalized().cast<float>();
      log.range_m[i] = float(to.norm() + noise_m * random.normal());
      log.time_s[i] = 1e-4 * double(i);
    }
  }
  return log;
}

TEST(FitOfAWall, IsAsThinAsItsNoise) {
  const BeamLog log = scan_of_a_wall(20000, 1, 0.002);
  MemorySource source(log);
  FitOptions options;
  options.segment.method = "none";
  const elements::Model model = fit(source, options).model;
  ASSERT_GT(model.ellipsoids.size(), 1000u);
  std::vector<double> thickness;
  for (const elements::Ellipsoid& e : model.ellipsoids) {
    thickness.push_back(std::sqrt(eigenvalues(e.covariance_matrix())[0]));
  }
  std::nth_element(thickness.begin(), thickness.begin() + ptrdiff_t(thickness.size() / 2),
                   thickness.end());
  EXPECT_LT(thickness[thickness.size() / 2], 0.008);
}

TEST(FitOfAWall, RepeatedDirectionsMakeNoCopiesOfAnElement) {
  const BeamLog log = scan_of_a_wall(60, 200, 0.002);
  MemorySource source(log);
  FitOptions options;
  options.fitter = "hierarchical";
  options.segment.method = "none";
  EXPECT_LE(fit(source, options).model.ellipsoids.size(), 60u);
}

/// Adds a scan of so many rings, `between` rad apart, of the wall, which returns a share of the
/// beams. Their noise is 5 mm.
void add_rings(BeamLog& log, uint32_t scan, int rings, double first, double between, double share,
               Stream& random) {
  constexpr double kStep = 0.001;
  constexpr int kColumns = 400;
  log.info.scans.push_back({scan, 0.1 * scan, {}});
  for (int ring = 0; ring < rings; ++ring) {
    for (int column = 0; column < kColumns; ++column) {
      const double east = kStep * (column - kColumns / 2), up = first + between * ring;
      const Vec3 to = 10 * Vec3(std::tan(east), 1, std::tan(up));
      const size_t i = log.size();
      log.resize(i + 1);
      log.direction[i] = to.normalized().cast<float>();
      log.range_m[i] = kMiss;
      if (random.uniform() < share) log.range_m[i] = float(to.norm() + 0.005 * random.normal());
      log.ring[i] = uint16_t(ring);
      log.scan[i] = scan;
      log.time_s[i] = 0.1 * scan + 1e-5 * column;
    }
  }
}

double share_of_returns(const BeamLog& log) {
  size_t hits = 0;
  for (size_t i = 0; i < log.size(); ++i) hits += log.is_hit(i);
  return double(hits) / double(log.size());
}

/// The share of the beams from (0, 0, 0) half way between the rings of scans that return, where
/// `share` of those of the rings do. The scans are 0.6 m apart on a level way along the wall.
double between_the_rings(double share, uint32_t scans = 1) {
  Stream random(29);
  BeamLog log, asked;
  log.info.has_misses = asked.info.has_misses = true;
  log.info.max_range_m = asked.info.max_range_m = 40;
  constexpr double kBetween = 0.02;
  for (uint32_t scan = 0; scan < scans; ++scan) {
    const size_t first = log.size();
    add_rings(log, scan, 12, 0.01, kBetween, share, random);
    for (size_t i = first; i < log.size(); ++i) log.origin[i].x() = 0.6 * scan;
    log.info.scans.back().world_from_sensor.translation.x() = 0.6 * scan;
  }
  add_rings(asked, 0, 11, 0.01 + kBetween / 2, kBetween, 0, random);
  MemorySource source(log);
  FitOptions options;
  options.segment.method = "none";
  const elements::Model model = fit(source, options).model;
  simulate::simulate(trace::World(model), {}, 0, asked);
  return share_of_returns(asked);
}

TEST(FitOfAWall, IsClosedBetweenTheRingsOfAScan) { EXPECT_GT(between_the_rings(1), 0.95); }

// The rings of all scans fall on each other and close no gap.
TEST(FitOfAWall, IsClosedBetweenTheRingsOfALevelDriveAlongIt) {
  EXPECT_GT(between_the_rings(1, 16), 0.97);
}

TEST(FitOfAWall, BetweenTheRingsAPermeableOneReturnsSomeOfTheBeams) {
  const double share = between_the_rings(0.6);
  EXPECT_GT(share, 0.48);
  EXPECT_LT(share, 0.6);
}

TEST(FitOfAWall, ASensorThatStandsStillShowsItsNoise) {
  BeamLog log;
  Stream random(31);
  log.info.has_misses = true;
  for (uint32_t scan = 0; scan < 4; ++scan) add_rings(log, scan, 8, 0.01, 0.01, 1, random);
  FitOptions options;
  options.segment.method = "none";
  MemorySource source(log);
  EXPECT_NEAR(fit(source, options).report.range_noise_m, 0.005, 5e-4);
  options.range_noise_m = 0.003;
  EXPECT_EQ(fit(source, options).report.range_noise_m, 0.003);
  for (size_t i = 0; i < log.size(); ++i) log.origin[i] = Vec3(0, 0, 0.2 * log.scan[i]);
  for (ScanInfo& scan : log.info.scans) scan.world_from_sensor.translation.z() = 0.2 * scan.scan;
  MemorySource drive(log);
  EXPECT_EQ(fit(drive, {}).report.range_noise_m, 0.02);
}

}  // namespace
}  // namespace underbrush::fit
