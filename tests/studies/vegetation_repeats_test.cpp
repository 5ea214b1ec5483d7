#include "studies/vegetation_repeats.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/elements/classes.hpp"

namespace underbrush::studies {
namespace {

// A wall stands before the sensor and scattered leaves to its left. Every class is tree, and every
// seventh beam is a miss.
TEST(VegetationRepeats, WallsAreUprightPlanesAndMissesBelongToWhatIsAboutThem) {
  constexpr int kRings = 20, kBearings = 200;
  BeamLog scan;
  scan.info.has_misses = true;
  scan.resize(kRings * kBearings);
  const std::vector<uint8_t> label(scan.size(), uint8_t(elements::Class::kLargeTree));
  for (size_t i = 0; i < scan.size(); ++i) {
    const int ring = int(i) / kBearings, bearing = int(i) % kBearings;
    const double azimuth = (bearing - 40) * 0.5 * M_PI / 180, up = (ring - 10) * 0.5 * M_PI / 180;
    const Vec3 d(std::cos(up) * std::cos(azimuth), std::cos(up) * std::sin(azimuth), std::sin(up));
    scan.direction[i] = d.cast<float>();
    scan.ring[i] = uint16_t(ring);
    const double depth = 8 + 4 * uniform_from_bits(random_bits(1, uint32_t(i), Purpose::kPlace));
    if (i % 7) scan.range_m[i] = float(bearing < 80 ? 10 / d.x() : depth);
  }
  const auto targets = targets_of(scan, label);
  size_t right = 0, wrong = 0;
  for (size_t i = 0; i < scan.size(); ++i) {
    const int bearing = int(i) % kBearings;
    if (std::abs(bearing - 80) < 8) continue;  // Either side of the wall's end.
    const bool wall = bearing < 80;
    right += targets[2][i] == wall && targets[0][i] == !wall;
    wrong += targets[2][i] != wall || targets[0][i] == wall;
    EXPECT_FALSE(targets[1][i]);
    EXPECT_TRUE(targets[3][i]);
  }
  EXPECT_LT(double(wrong), 0.02 * double(right));
}

}  // namespace
}  // namespace underbrush::studies
