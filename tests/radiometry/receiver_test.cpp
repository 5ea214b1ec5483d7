#include "underbrush/radiometry/receiver.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"

namespace underbrush::radiometry {
namespace {

/// The echoes of point targets, one a range, each of weight 1 and factor `factor`.
struct Bench {
  explicit Bench(const ReceiverOptions& options) : receiver(options), scratch(receiver.scratch()) {}

  Echoes operator()(std::vector<float> range, float factor = 1, uint64_t beam = 0,
                    Receiver::Way way = Receiver::Way::kFast) {
    std::vector<float> weight(range.size(), 1), factors(range.size(), factor), signal(range.size());
    return receiver.receive(range, weight, factors, signal, beam_key(5, 0, beam), scratch, way);
  }

  Receiver receiver;
  Waveform scratch;
};

ReceiverOptions quiet() {
  ReceiverOptions o;
  o.noise_sigma = 0;
  return o;
}

TEST(Receiver, PowerFallsWithTheSquareOfTheRangeAndTheAir) {
  ReceiverOptions o = quiet();
  o.extinction_per_m = 0.004;
  o.signal_at_1m = 1e6;
  Bench bench(o);
  for (float range = 1.0f; range < 119; range += 3.37f) {
    const Echoes e = bench({range}, 0.7f);
    ASSERT_EQ(e.count, 1) << range;
    const double r = double(range), expected = 1e6 * 0.7 * std::exp(-0.008 * r) / (r * r);
    EXPECT_NEAR(e.echo[0].peak, expected, 0.01 * expected) << range;
    EXPECT_NEAR(e.echo[0].energy, expected, 0.005 * expected + 0.05) << range;
  }
  // The signals are compared with those of the standard library.
  std::vector<float> range, ones(500, 1), signal(500);
  for (int k = 0; k < 500; ++k) range.push_back(0.02f + 2.3f * float(k));
  bench.receiver.signals(range, ones, ones, signal);
  for (size_t k = 0; k < range.size(); ++k) {
    const double r = double(range[k]), exact = 1e6 * std::exp(-0.008 * r) / (r * r);
    EXPECT_NEAR(signal[k], exact, 2e-6 * exact);
  }
}

TEST(Receiver, ReflectanceIsRestoredAtAnyRange) {
  ReceiverOptions o = quiet();
  o.extinction_per_m = 0.002;
  o.signal_at_1m = 1e6;
  o.intensity = Intensity::kReflectance;
  o.intensity_scale = 100;
  o.intensity_resolution = 1;
  o.intensity_most = 255;
  Bench bench(o);
  for (float range = 2; range < 110; range += 7) {
    const Echoes e = bench({range}, 0.4f);
    ASSERT_EQ(e.count, 1);
    EXPECT_NEAR(e.echo[0].intensity, 40, 1) << range;
    EXPECT_EQ(e.echo[0].intensity, std::round(e.echo[0].intensity));
    EXPECT_EQ(bench({range}, 9).echo[0].intensity, 255);
  }
}

// The mean and the standard deviation of the ranges must be those configured.
TEST(Receiver, RangesHaveTheConfiguredAccuracyAndNoBias) {
  for (const double sigma : {0.007, 0.03}) {
    for (const double step : {0.0, 0.004, 0.05}) {
      ReceiverOptions o = quiet();
      o.range_sigma_m = sigma;
      o.range_resolution_m = step;
      Bench bench(o);
      double mean = 0, square = 0;
      constexpr int kN = 20000;
      Stream random(6);
      for (int k = 0; k < kN; ++k) {
        const float range = float(random.uniform(20, 21));
        const double error = double(bench({range}, 1, uint64_t(k)).echo[0].range_m) - double(range);
        mean += error / kN;
        square += error * error / kN;
      }
      const double expected = std::sqrt(sigma * sigma + step * step / 12);
      EXPECT_NEAR(mean, 0, 4 * expected / std::sqrt(kN) + 3e-4);
      EXPECT_NEAR(std::sqrt(square), expected, 0.02 * expected + 2e-4);
    }
  }
}

TEST(Receiver, RangesIntensitiesAndWidthsAreWholeSteps) {
  ReceiverOptions o = quiet();
  o.range_resolution_m = 0.25;
  o.intensity_resolution = 0.5;
  o.width_resolution_m = 0.125;
  Bench bench(o);
  const Echo e = bench({33.333f}).echo[0];
  EXPECT_EQ(e.range_m, 33.25f);
  EXPECT_EQ(e.intensity * 2, std::round(e.intensity * 2));
  EXPECT_EQ(e.width_m * 8, std::round(e.width_m * 8));
}

// Half of the targets are found at the range of the calibration, nearly all well before it, and
// nearly none well beyond.
TEST(Receiver, DetectionRangeIsThatOfTheCalibration) {
  ReceiverOptions o;
  o.max_range_m = 250;
  o.detector.threshold = 6;
  o.false_alarms = false;
  o.signal_at_1m = signal_from_detection_range(100, 0.1, 6, 0);
  Bench bench(o);
  const auto found = [&](float range) {
    int n = 0;
    for (uint64_t k = 0; k < 2000; ++k) n += bench({range}, 0.1f, k).count == 1;
    return n / 2000.0;
  };
  EXPECT_GT(found(70), 0.99);
  // Noise lifts one of several samples near the peak, so somewhat more than half are found.
  EXPECT_GT(found(100), 0.45);
  EXPECT_LT(found(100), 0.85);
  EXPECT_LT(found(140), 0.02);
}

// Every sensor of the catalogue finds its stated target nearer than stated and loses it beyond. Its
// echoes are in its own steps, and its pulses are unbiased.
TEST(Receiver, EverySensorOfTheCatalogueDetectsAsItsFileSays) {
  for (const std::string& name : sensor::names()) {
    const sensor::Sensor s = sensor::load(name);
    Bench bench(receiver_options(s));
    const double range = s.signal.detection_range_m;
    const auto factor = float(s.signal.detection_reflectance);
    const auto found = [&](double at) {
      int n = 0;
      for (uint64_t k = 0; k < 200; ++k) n += bench({float(at)}, factor, k).count > 0;
      return n / 200.0;
    };
    EXPECT_GT(found(0.8 * range), 0.95) << name;
    if (1.5 * range < s.max_range_m) {
      EXPECT_LT(found(1.5 * range), 0.05) << name;
    }
    double mean = 0;
    for (uint64_t k = 0; k < 400; ++k) {
      const float at = float(0.2 * range + 0.01 * double(k));
      const Echoes e = bench({at}, 0.5f, k);
      ASSERT_EQ(e.count, 1) << name;
      mean += double(e.echo[0].range_m - at) / 400;
      if (s.range_resolution_m > 0) {
        const double steps = double(e.echo[0].range_m) / s.range_resolution_m;
        EXPECT_NEAR(steps, std::round(steps), 0.02) << name;
      }
    }
    EXPECT_NEAR(mean, 0, 0.004 + 0.2 * s.range_sigma_m) << name;
  }
}

/// The number of alarms a sample of noise that is drawn sample by sample.
double alarms_a_sample(const ReceiverOptions& o) {
  Bench bench(o);
  double alarms = 0, samples = 0;
  // Returns far below the noise make the waveform draw the noise of the samples that they reach.
  std::vector<float> range, signal;
  for (float r = 2; r < 118; r += 0.5f) range.push_back(r), signal.push_back(1e-6f);
  for (uint64_t k = 0; k < 3000; ++k) {
    const Echoes e = bench.receiver.receive(range, signal, beam_key(7, 0, k), bench.scratch);
    alarms += e.count;
    samples += double(bench.scratch.touched());
  }
  return alarms / samples;
}

TEST(Receiver, NoiseAloneAlarmsAsOftenAsNoiseThatIsDrawnSampleBySample) {
  for (const double fwhm_ns : {0.0, 4.0}) {
    for (const double sample_ns : {0.5, 2.0}) {
      ReceiverOptions o;
      o.detector.threshold = 3;
      o.response = {Pulse::kGaussian, 5e-9, fwhm_ns * 1e-9, sample_ns * 1e-9};
      o.mode = ReturnMode::kAll;
      o.max_echoes = Echoes::kMost;
      o.false_alarms = false;
      const double drawn = alarms_a_sample(o);
      o.false_alarms = true;
      o.max_echoes = 1;
      Bench bench(o);
      int alarms = 0;
      constexpr int kN = 20000;
      double range = 0;
      for (uint64_t k = 0; k < kN; ++k) {
        const Echoes e = bench({}, 1, k);
        if (e.count == 0) continue;
        ++alarms;
        range += double(e.echo[0].range_m);
        EXPECT_GE(e.echo[0].peak, 3.0f);
      }
      const double expected = drawn * double(bench.scratch.size());
      EXPECT_NEAR(alarms / double(kN), expected, 0.15 * expected) << fwhm_ns << " " << sample_ns;
      EXPECT_NEAR(range / alarms, 60, 5);
      o.false_alarms = false;
      Bench silent(o);
      for (uint64_t k = 0; k < 100; ++k) EXPECT_EQ(silent({}, 1, k).count, 0);
    }
  }
}

TEST(Receiver, OneFlatTargetGivesOneEcho) {
  for (const double fwhm_ns : {0.0, 4.0}) {
    for (const double sample_ns : {0.25, 1.0, 2.0}) {
      for (const double threshold : {4.0, 5.0, 10.0}) {
        ReceiverOptions o;
        o.response = {Pulse::kGaussian, 5e-9, fwhm_ns * 1e-9, sample_ns * 1e-9};
        o.detector.threshold = float(threshold);
        o.mode = ReturnMode::kAll;
        o.max_echoes = Echoes::kMost;
        o.false_alarms = false;
        Bench bench(o);
        for (const double snr : {4.0, 6.4, 8.7, 15.0, 40.0, 200.0, 1000.0}) {
          int detected = 0, several = 0;
          for (uint64_t k = 0; k < 3000; ++k) {
            const float range = 40 + 0.001f * float(k), signal = float(snr);
            const Echoes e =
                bench.receiver.receive({&range, 1}, {&signal, 1}, beam_key(9, 0, k), bench.scratch);
            detected += e.count > 0;
            several += e.count > 1;
          }
          EXPECT_LE(several, 0.001 * detected + 2)
              << fwhm_ns << " ns, " << sample_ns << " ns, " << threshold << ", " << snr;
          if (snr > 1.5 * threshold) {
            EXPECT_GT(detected, 2900) << snr;
          }
        }
      }
    }
  }
}

/// The standard deviation of the range of a flat target at many places, m.
double spread_of_range(const ReceiverOptions& o, float signal) {
  Bench bench(o);
  double n = 0, sum = 0, square = 0;
  for (uint64_t k = 0; k < 2000; ++k) {
    const float range = float(0.4 * o.max_range_m) + 0.001f * float(k);
    const Echoes e =
        bench.receiver.receive({&range, 1}, {&signal, 1}, beam_key(3, 0, k), bench.scratch);
    if (e.count != 1) continue;
    const double error = double(e.echo[0].range_m) - double(range);
    ++n, sum += error, square += error * error;
  }
  EXPECT_GT(n, 1990);
  return std::sqrt(square / n - sum / n * (sum / n));
}

TEST(Receiver, TheRangeOfAFlatTargetVariesAsTheDataSheetSaysOrAsTheNoiseAlone) {
  for (const std::string& name : sensor::names()) {
    ReceiverOptions o = receiver_options(sensor::load(name));
    o.range_resolution_m = 0;
    o.false_alarms = false;
    o.mode = ReturnMode::kStrongest;
    ReceiverOptions without = o;
    without.range_sigma_m = 0;
    for (const float signal : {40.0f, 150.0f, 600.0f}) {
      if (signal < 3 * o.detector.threshold || signal > 0.5f * o.adc_most) continue;
      const double expected = std::max(o.range_sigma_m, spread_of_range(without, signal));
      EXPECT_NEAR(spread_of_range(o, signal), expected, 0.06 * expected) << name << " " << signal;
    }
  }
}

TEST(Receiver, TakesTheStepOfTheConverterFromTheSensor) {
  sensor::Sensor s = sensor::load("generic-spinning");
  EXPECT_EQ(receiver_options(s).adc_step, 0);
  s.signal.adc_step_snr = 3;
  s.check();
  Bench bench(receiver_options(s));
  bench({20}, 0.5f, 0, Receiver::Way::kByWaveform);
  size_t samples = 0;
  for (const auto& [range, signal] : table_of(bench.scratch)) {
    EXPECT_NEAR(signal / 3, std::round(signal / 3), 1e-5);
    ++samples;
  }
  EXPECT_GT(samples, 10u);
  s.signal.adc_step_snr = -1;
  EXPECT_THROW(s.check(), std::invalid_argument);
}

TEST(Receiver, ModesChooseAmongTheEchoes) {
  ReceiverOptions o = quiet();
  const auto ranges = [&](ReturnMode mode, int most) {
    o.mode = mode;
    o.max_echoes = most;
    o.min_range_m = 3;
    Bench bench(o);
    const float range[] = {2, 20, 40, 60}, signal[] = {999, 30, 80, 50};
    const Echoes e = bench.receiver.receive({range, 4}, {signal, 4}, 1, bench.scratch);
    std::vector<int> found;
    for (const Echo& echo : e) found.push_back(int(std::lround(echo.range_m)));
    return found;
  };
  EXPECT_EQ(ranges(ReturnMode::kFirst, 1), std::vector<int>{20});
  EXPECT_EQ(ranges(ReturnMode::kLast, 1), std::vector<int>{60});
  EXPECT_EQ(ranges(ReturnMode::kStrongest, 1), std::vector<int>{40});
  EXPECT_EQ(ranges(ReturnMode::kAll, 2), (std::vector<int>{40, 60}));
  EXPECT_EQ(ranges(ReturnMode::kAll, 9), (std::vector<int>{20, 40, 60}));
}

TEST(Receiver, TheSameKeyGivesTheSameEchoesWhateverTheScratchHeldBefore) {
  ReceiverOptions o;
  o.range_sigma_m = 0.02;
  o.mode = ReturnMode::kAll;
  o.max_echoes = 5;
  Bench one(o), two(o);
  two({80.0f, 90.0f}, 1, 77);
  const Echoes a = one({30, 50, 50.5f}, 0.3f, 4), b = two({30, 50, 50.5f}, 0.3f, 4);
  const Echoes c = two({30, 50, 50.5f}, 0.3f, 5);
  ASSERT_EQ(a.count, b.count);
  for (int k = 0; k < a.count; ++k) {
    EXPECT_EQ(a.echo[size_t(k)].range_m, b.echo[size_t(k)].range_m);
    EXPECT_EQ(a.echo[size_t(k)].intensity, b.echo[size_t(k)].intensity);
  }
  EXPECT_NE(a.echo[0].range_m, c.echo[0].range_m);
}

TEST(Receiver, RefusesOptionsThatAreNone) {
  const auto refused = [](auto change) {
    ReceiverOptions o;
    change(o);
    EXPECT_THROW(Receiver{o}, std::invalid_argument);
  };
  refused([](auto& o) { o.max_range_m = o.min_range_m; });
  refused([](auto& o) { o.noise_sigma = -1; });
  refused([](auto& o) { o.signal_at_1m = NAN; });
  refused([](auto& o) { o.range_resolution_m = -1; });
  refused([](auto& o) { o.max_echoes = 17; });
  refused([](auto& o) { o.adc_most = 0; });
}

}  // namespace
}  // namespace underbrush::radiometry
