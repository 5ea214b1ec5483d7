#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/radiometry/receiver.hpp"

namespace underbrush::radiometry {
namespace {

TEST(Sunlight, TheNoiseOfABeamGrowsWithTheBrightnessOfWhatItSees) {
  ReceiverOptions o;
  o.sunlit_variance = 3;
  o.extinction_per_m = 0.01;
  const Receiver receiver(o);
  const auto scale = [&](std::vector<float> range, std::vector<float> weight,
                         std::vector<float> factor) {
    return double(receiver.noise_scale(range, weight, factor));
  };
  EXPECT_NEAR(scale({}, {}, {}), std::sqrt(1 + 3 * 0.03), 1e-6);  // all of it is sky
  EXPECT_NEAR(scale({20}, {1}, {0.5f}), std::sqrt(1 + 3 * 0.5 * std::exp(-0.2)), 1e-6);
  const double half_sky = 0.25 * std::exp(-0.1) + 0.25 * 0.8 * std::exp(-0.5) + 0.25 * 0.03;
  EXPECT_NEAR(scale({10, 50, INFINITY}, {0.5f, 0.25f, 0.25f}, {0.5f, 0.8f, 1}),
              std::sqrt(1 + 3 * half_sky), 1e-6);
  const Receiver dark{ReceiverOptions{}};
  EXPECT_EQ(dark.noise_scale(std::vector<float>{20}, std::vector<float>{1}, std::vector<float>{1}),
            1);
}

/// The share of 400 beams on a target that has an echo near it.
double detected(double sunlit_variance, float range, float factor, double signal) {
  ReceiverOptions o;
  o.sunlit_variance = sunlit_variance;
  o.signal_at_1m = signal * double(range) * double(range) / double(factor);
  const Receiver receiver(o);
  Waveform scratch = receiver.scratch();
  int found = 0;
  for (uint64_t k = 0; k < 400; ++k) {
    std::vector<float> one(1);
    const Echoes e = receiver.receive(std::vector<float>{range}, std::vector<float>{1},
                                      std::vector<float>{factor}, one, beam_key(7, 0, k), scratch);
    for (const Echo& echo : e) found += std::abs(echo.range_m - range) < 1;
  }
  return found / 400.0;
}

TEST(Sunlight, AThresholdIsThatOfTheBeamsOwnBackground) {
  // Two targets with a signal of 10 against a threshold of 5: by night both are found. In the sun
  // the threshold of the bright one is 5 √(1 + 6 · 0.9) = 12.6, and that of the dark one 5 √1.6
  // = 6.3.
  EXPECT_GT(detected(0, 30, 0.9f, 10), 0.99);
  EXPECT_GT(detected(0, 30, 0.1f, 10), 0.99);
  EXPECT_GT(detected(6, 30, 0.1f, 10), 0.95);
  EXPECT_LT(detected(6, 30, 0.9f, 10), 0.25);
}

TEST(Sunlight, FalseAlarmsAreAsRareAsInTheDark) {
  const auto alarms = [](double sunlit_variance) {
    ReceiverOptions o;
    o.detector.threshold = 3;
    o.sunlit_variance = sunlit_variance;
    const Receiver receiver(o);
    Waveform scratch = receiver.scratch();
    int found = 0;
    for (uint64_t k = 0; k < 4000; ++k) {
      found += receiver.receive({}, {}, {}, {}, beam_key(9, 0, k), scratch).count;
    }
    return found / 4000.0;
  };
  const double dark = alarms(0);
  EXPECT_GT(dark, 0.02);
  EXPECT_NEAR(alarms(100), dark, 4 * std::sqrt(dark / 4000));
}

}  // namespace
}  // namespace underbrush::radiometry
