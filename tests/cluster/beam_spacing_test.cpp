// The spacing of beams, and the extent that it leaves open, against patterns in which both are
// known.
#include "underbrush/cluster/beam_spacing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "underbrush/core/rng.hpp"

namespace underbrush::cluster {
namespace {

constexpr double kDegree = M_PI / 180;

/// A scan of 24 rings, 1.5° apart about the horizon, with a beam every 0.2°.
BeamLog scan_of_rings(bool tell_rings = true) {
  BeamLog log;
  for (int ring = 0; ring < 24; ++ring) {
    for (int column = 0; column < 1800; ++column) {
      const double azimuth = 0.2 * column * kDegree, height = 1.5 * (ring - 11.5) * kDegree;
      const size_t i = log.size();
      log.resize(i + 1);
      log.direction[i] = Vec3(std::cos(height) * std::cos(azimuth),
                              std::cos(height) * std::sin(azimuth), std::sin(height))
                             .cast<float>();
      log.ring[i] = tell_rings ? uint16_t(ring) : 0;
    }
  }
  return log;
}

BeamLog shuffled(const BeamLog& log, uint64_t seed) {
  std::vector<size_t> order(log.size());
  std::iota(order.begin(), order.end(), size_t(0));
  Stream random(seed);
  for (size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  BeamLog out = log.like();
  for (const size_t i : order) out.append(log, i);
  return out;
}

BeamSpacing spacing_of(const BeamLog& log) {
  MemorySource source(log, 5000);
  return beam_spacing(source);
}

TEST(BeamSpacing, IsThatOfTheSensor) {
  const BeamSpacing spacing = spacing_of(scan_of_rings());
  EXPECT_NEAR(spacing.in_ring / kDegree, 0.2, 0.01);
  EXPECT_NEAR(spacing.from_ring / kDegree, 1.5, 0.01);
}

TEST(BeamSpacing, DoesNotDependOnTheOrderOfTheBeams) {
  const BeamLog log = scan_of_rings();
  EXPECT_EQ(spacing_of(shuffled(log, 3)), spacing_of(log));
}

TEST(BeamSpacing, WithoutRingsIsThatToTheNearestBeam) {
  const BeamSpacing spacing = spacing_of(shuffled(scan_of_rings(false), 4));
  EXPECT_NEAR(spacing.in_ring / kDegree, 0.2, 0.01);
  EXPECT_EQ(spacing.from_ring, spacing.in_ring);
}

TEST(BeamSpacing, OfFewBeamsIsNone) {
  EXPECT_EQ(spacing_of({}), BeamSpacing());
  BeamLog log;
  log.resize(2);
  log.direction[0] = Vec3f(1, 0, 0);
  log.direction[1] = Vec3f(0, 1, 0);
  EXPECT_EQ(spacing_of(log), BeamSpacing());
}

constexpr BeamSpacing kSpacing{0.2 * kDegree, 1.5 * kDegree};

double even_variance(double angle) { return std::pow(10 * angle, 2) / 12; }

// The open covariances of two clusters, of points 10 m to the east of `places` places of a sensor
// that are 1 m apart from south to north. The rings of place k pass k · `part` of their gap above
// those of the first.
std::vector<Eigen::Matrix3f> open_of_places(int places, double part) {
  std::vector<Vec3f> points, to_sensor;
  Clusters clusters;
  for (int k = 0; k < 20; ++k) {
    const int place = k % places;
    points.emplace_back(10, 0.001f * float(k), float(place * part * 10 * kSpacing.from_ring));
    to_sensor.emplace_back(-10, float(place), 0);
    clusters.group.push_back(k == 7 ? Clusters::kNone : k < 10 ? 0 : 1);
  }
  clusters.count = 2;
  return open_covariances(points, to_sensor, clusters, kSpacing);
}

TEST(OpenCovariance, IsThatOfEvenMatterBetweenTheBeams) {
  const std::vector<Eigen::Matrix3f> open = open_of_places(1, 0);
  ASSERT_EQ(open.size(), 2u);
  for (const Eigen::Matrix3f& m : open) {
    EXPECT_NEAR(m(1, 1) / even_variance(kSpacing.in_ring), 1, 0.01);
    EXPECT_NEAR(m(2, 2) / even_variance(kSpacing.from_ring), 1, 0.01);
    EXPECT_LT(m(0, 0), 1e-3 * m(1, 1));
  }
}

// Rings that divide a gap into n equal parts leave 1 / n² of the variance, and rings that fall on
// those of the other places all of it, as those of a sensor that drives along a wall do.
TEST(OpenCovariance, IsReducedByBeamsThatFallIntoTheGaps) {
  for (const int places : {2, 3, 5}) {
    for (const bool divides : {false, true}) {
      for (const Eigen::Matrix3f& m : open_of_places(places, divides ? 1.0 / places : 0)) {
        const double share = divides ? 1.0 / (places * places) : 1;
        // The places are up to 4 m aside, which makes ranges and directions differ somewhat.
        EXPECT_NEAR(m(2, 2) / (share * even_variance(kSpacing.from_ring)), 1, 0.15);
      }
    }
  }
}

}  // namespace
}  // namespace underbrush::cluster
