#include "underbrush/metrics/reliability.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"

namespace underbrush::metrics {
namespace {

TEST(Reliability, OfThreeBeamsByHand) {
  Reliability r;
  EXPECT_TRUE(std::isnan(r.error()) && std::isnan(r.bias()));
  r.add(0.96, true);
  r.add(0.98, false);
  r.add(0.31, true);
  EXPECT_EQ(r.beams(), 3u);
  EXPECT_EQ(r.bins()[19].beams, 2u);
  EXPECT_EQ(r.bins()[19].returns, 1u);
  EXPECT_EQ(r.bins()[6].returns, 1u);
  EXPECT_NEAR(r.error(), (0.94 + 0.69) / 3, 1e-12);
  EXPECT_NEAR(r.bias(), (0.94 - 0.69) / 3, 1e-12);
  r.add(1, true);
  EXPECT_EQ(r.bins()[19].beams, 3u);
}

TEST(Reliability, TellsCalibratedFromOverconfident) {
  Stream random(61);
  Reliability calibrated, overconfident;
  for (int k = 0; k < 200000; ++k) {
    const double p = random.uniform();
    const bool returned = random.uniform() < p;
    calibrated.add(p, returned);
    overconfident.add(p < 0.5 ? 0.5 * p : 1 - 0.5 * (1 - p), returned);
  }
  EXPECT_LT(calibrated.error(), 0.005);
  EXPECT_NEAR(overconfident.error(), 0.125, 0.005);  // the mean distance between p and its half
  EXPECT_NEAR(overconfident.bias(), 0, 0.005);
}

}  // namespace
}  // namespace underbrush::metrics
