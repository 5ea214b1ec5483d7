#include "underbrush/radiometry/detector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace underbrush::radiometry {
namespace {

const ResponseOptions kPulse{Pulse::kGaussian, 5e-9, 0, 1e-9};
const ResponseOptions kPulses[] = {{Pulse::kGaussian, 5e-9, 0, 1e-9},
                                   {Pulse::kGaussian, 5e-9, 3e-9, 2e-9},
                                   {Pulse::kQSwitched, 8e-9, 0, 1e-9},
                                   {Pulse::kQSwitched, 5e-9, 2e-9, 1e-9}};
const double kSigma = kSpeedOfLight / 2 * 5e-9 / std::sqrt(8 * M_LN2);  // m

Echoes echoes_of(const Response& h, const DetectorOptions& options, std::vector<float> range,
                 std::vector<float> amplitude) {
  Waveform w(h, 120);
  w.add(range, amplitude);
  return Detector(h, options).detect(w);
}

class Timings : public testing::TestWithParam<std::tuple<Timing, Pulse>> {};

// No range is biased, over all places within a cell and all strengths. The published chain rounds
// returns up to cells of 0.03 m and is half a cell too far.
TEST_P(Timings, AreUnbiasedInRange) {
  const auto [timing, pulse] = GetParam();
  const Response h({pulse, 5e-9, 2e-9, 1e-9});
  DetectorOptions options;
  options.timing = timing;
  const Detector detector(h, options);
  Waveform w(h, 60);
  for (const float peak : {7.0f, 20.0f, 200.0f, 5000.0f}) {
    double bias = 0, worst = 0, rounded_up = 0;
    constexpr int kN = 500;
    for (int k = 0; k < kN; ++k) {
      const float range = float(30 + 2 * h.cell_m() * (k + 0.5) / kN);
      w.clear();
      w.add({&range, 1}, {&peak, 1});
      const Echoes found = detector.detect(w);
      ASSERT_EQ(found.count, 1);
      const double error = double(found.echo[0].range_m) - double(range);
      bias += error / kN;
      worst = std::max(worst, std::abs(error));
      rounded_up += (0.03 * std::ceil(double(range) / 0.03) - double(range)) / kN;
      EXPECT_NEAR(found.echo[0].peak, peak, 0.02f * peak);
    }
    // The steep front of a Q-switched pulse lies between two samples. Its single crossings are
    // coarse, but their mean is not.
    const bool coarse = timing == Timing::kLeadingEdge && pulse == Pulse::kQSwitched;
    EXPECT_NEAR(bias, 0, coarse ? 2e-3 : 5e-4) << peak;
    EXPECT_LT(worst, coarse ? 0.05 : 0.012) << peak;
    EXPECT_NEAR(rounded_up, 0.015, 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Timings,
                         testing::Combine(testing::Values(Timing::kPeak, Timing::kLeadingEdge,
                                                          Timing::kConstantFraction),
                                          testing::Values(Pulse::kGaussian, Pulse::kQSwitched)));

TEST(Detector, PulseWidthIsThatOfTheGaussianAboveTheThreshold) {
  const Response h(kPulse);
  for (const float peak : {10.0f, 50.0f, 400.0f}) {
    for (float range : {40.0f, 40.05f, 40.1f}) {
      const Echoes e = echoes_of(h, {}, {range}, {peak});
      ASSERT_EQ(e.count, 1);
      EXPECT_NEAR(e.echo[0].width_m, 2 * kSigma * std::sqrt(2 * std::log(double(peak) / 5)), 0.02);
      EXPECT_NEAR(e.echo[0].energy, peak, 2e-3 * double(peak));
    }
  }
}

// A step of depth d takes a share s of the beam. It gives two echoes with the ranges and energies
// of both surfaces where the pulse can separate them, else one mixed pixel at their mean.
TEST(Detector, AnEdgeGivesTwoEchoesOrAMixedPixel) {
  const Response h(kPulse);
  for (const double share : {0.3, 0.5, 0.8}) {
    for (const double depth : {2.5, 3.0, 10.0, 50.0}) {
      const float a = float(100 * share), b = float(100 * (1 - share));
      const Echoes e = echoes_of(h, {}, {20, float(20 + depth)}, {a, b});
      ASSERT_EQ(e.count, 2) << depth;
      EXPECT_NEAR(e.echo[0].range_m, 20, 2e-3);
      EXPECT_NEAR(e.echo[1].range_m, 20 + depth, 2e-3);
      EXPECT_NEAR(e.echo[0].energy, a, 0.01 * a);
      EXPECT_NEAR(e.echo[1].energy, b, 0.01 * b);
      EXPECT_NEAR(e.echo[0].energy + e.echo[1].energy, 100, 0.3);
    }
    const Echoes mixed =
        echoes_of(h, {}, {20, 20.2f}, {float(100 * share), float(100 - 100 * share)});
    ASSERT_EQ(mixed.count, 1);
    EXPECT_NEAR(mixed.echo[0].range_m, 20 + 0.2 * (1 - share), 6e-3);
    EXPECT_NEAR(mixed.echo[0].energy, 100, 0.5);
    EXPECT_GT(mixed.echo[0].range_m, 20.01);
  }
}

// Two equal Gaussians have two maxima from d = 2 σ on. With a valley of 0.7 they are separated from
// where 2 exp(−d²/8σ²) < 0.7 (1 + exp(−d²/2σ²)).
TEST(Detector, SeparatesWhereTheValleyIsDeepEnough) {
  const Response h(kPulse);
  double limit = 2 * kSigma;
  const auto valley = [](double d) {
    const double x = d * d / (kSigma * kSigma);
    return 2 * std::exp(-x / 8) / (1 + std::exp(-x / 2));
  };
  while (valley(limit) > 0.7) limit += 1e-4;
  for (const double d : {limit - 0.06, limit + 0.06}) {
    int two = 0;
    for (int k = 0; k < 20; ++k) {
      const float r = float(30 + k * h.cell_m() / 20);
      two += echoes_of(h, {}, {r, float(double(r) + d)}, {100, 100}).count == 2;
    }
    EXPECT_EQ(two, d < limit ? 0 : 20) << d;
  }
  DetectorOptions wide;
  wide.min_gap_m = 5;  // as in the published chain
  const Echoes one = echoes_of(h, wide, {20, 24}, {100, 120});
  ASSERT_EQ(one.count, 1);
  EXPECT_NEAR(one.echo[0].range_m, 24, 2e-3);
  EXPECT_NEAR(echoes_of(h, wide, {20, 24}, {120, 100}).echo[0].range_m, 20, 2e-3);
  EXPECT_EQ(echoes_of(h, wide, {20, 26}, {100, 120}).count, 2);
}

// The parabola through three samples of an asymmetric pulse errs by an amount that depends on where
// the target lies between them. The tables remove the error, which is there without them.
TEST(Detector, TheBiasOfInterpolationIsTabulatedAway) {
  for (const ResponseOptions& pulse : kPulses) {
    const Response h(pulse);
    Waveform w(h, 60);
    for (const Timing timing : {Timing::kPeak, Timing::kConstantFraction}) {
      DetectorOptions options;
      options.timing = timing;
      const Detector detector(h, options);
      double worst = 0, raw = 0;
      for (int k = 0; k < 777; ++k) {
        const float range = float(30 + 3 * h.cell_m() * k / 777), peak = 300;
        w.clear();
        w.add({&range, 1}, {&peak, 1});
        const Echoes e = detector.detect(w);
        ASSERT_EQ(e.count, 1);
        worst = std::max(worst, std::abs(double(e.echo[0].range_m - range)));
        const float* s = std::max_element(w.samples(), w.samples() + w.size());
        const double a = std::log(double(s[-1] / s[0])), c = std::log(double(s[1] / s[0]));
        const double vertex = double(s - w.samples()) + 0.5 * (a - c) / (a + c);
        raw = std::max(raw, std::abs(w.range_m(vertex) - double(range)));
      }
      EXPECT_LT(worst, 0.02 * h.cell_m());  // a place of the table, and 1/256 cell of the waveform
      if (pulse.pulse == Pulse::kQSwitched) {
        EXPECT_GT(raw, 0.03 * h.cell_m());
      }
    }
  }
}

// From the threshold to a hundred times saturation, every timing of every pulse is unbiased over
// the places within a cell. The middle of the plateau would be up to ten cells late.
TEST(Detector, SaturatedPulsesKeepTheirRange) {
  constexpr float kSaturation = 1000;
  for (const ResponseOptions& pulse : kPulses) {
    const Response h(pulse);
    Waveform w(h, 100);
    for (const Timing timing : {Timing::kPeak, Timing::kLeadingEdge, Timing::kConstantFraction}) {
      DetectorOptions options;
      options.timing = timing;
      options.saturation = kSaturation;
      const Detector detector(h, options);
      double middle = 0;
      for (float peak = 1.1f * kSaturation; peak <= 100 * kSaturation; peak *= 1.35f) {
        double bias = 0, worst = 0;
        constexpr int kN = 64;
        for (int k = 0; k < kN; ++k) {
          const float range = float(50 + h.cell_m() * (k + 0.5) / kN);
          w.clear();
          w.add({&range, 1}, {&peak, 1});
          w.quantise(0, kSaturation);
          const Echoes e = detector.detect(w);
          ASSERT_EQ(e.count, 1);
          EXPECT_EQ(e.echo[0].peak, kSaturation);
          const double error = double(e.echo[0].range_m - range);
          bias += error / kN;
          worst = std::max(worst, std::abs(error));
          const float* top = std::max_element(w.samples(), w.samples() + w.size());
          const float* end = top;
          while (*end == kSaturation) ++end;
          const double half = 0.5 * double((top - w.samples()) + (end - 1 - w.samples()));
          middle = std::max(middle, w.range_m(half) - double(range));
        }
        const std::string where = testing::PrintToString(peak);
        // A front that rises from nothing to saturation within one sample is known to half a
        // sample.
        EXPECT_LT(std::abs(bias), 0.03 * h.cell_m()) << where;
        EXPECT_LT(worst, 0.5 * h.cell_m()) << where;
      }
      if (pulse.pulse == Pulse::kQSwitched) {
        EXPECT_GT(middle, 2 * h.cell_m());
      }
    }
  }
}

TEST(Detector, FindsNothingBelowTheThresholdAndKeepsTheLastOfMany) {
  const Response h(kPulse);
  EXPECT_EQ(echoes_of(h, {}, {20}, {4.9f}).count, 0);
  EXPECT_EQ(echoes_of(h, {}, {}, {}).count, 0);
  std::vector<float> range, amplitude(30, 50);
  for (int k = 0; k < 30; ++k) range.push_back(float(3 * k + 3));
  const Echoes e = echoes_of(h, {}, range, amplitude);
  ASSERT_EQ(e.count, Echoes::kMost);
  EXPECT_NEAR(e.echo[0].range_m, 3, 2e-3);
  EXPECT_NEAR(e.echo[Echoes::kMost - 1].range_m, 90, 2e-3);
}

TEST(Detector, RefusesOptionsThatAreNone) {
  const Response h(kPulse);
  DetectorOptions o;
  o.threshold = 0;
  EXPECT_THROW(Detector(h, o), std::invalid_argument);
  o = {};
  o.valley = 1.5;
  EXPECT_THROW(Detector(h, o), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::radiometry
