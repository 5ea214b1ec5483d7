#include "underbrush/radiometry/lone_echo.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/radiometry/receiver.hpp"

namespace underbrush::radiometry {
namespace {

using Way = Receiver::Way;

/// Moments of a reported value over many beams.
struct Moments {
  double sum = 0, square = 0, n = 0;
  void add(double v) { sum += v, square += v * v, n += 1; }
  double mean() const { return sum / n; }
  double spread() const { return std::sqrt(std::max(0.0, square / n - mean() * mean())); }
};

/// The echoes that a receiver reports of one target at many ranges.
struct Reported {
  Moments error, intensity, width, energy;
  double error_by_intensity = 0;
  int other = 0;  // beams without exactly one echo

  Reported(const Receiver& receiver, float signal, float noise_scale, Way way, int sub_rays) {
    Waveform scratch = receiver.scratch();
    constexpr int kBeams = 6000;
    std::vector<float> ranges, signals(size_t(sub_rays), signal / float(sub_rays));
    for (int b = 0; b < kBeams; ++b) {
      const float range = 31.0f + 7 * float(b) / kBeams;
      ranges.clear();
      for (int k = 0; k < sub_rays; ++k) {
        ranges.push_back(range + 0.01f * (float(k) - 0.5f * float(sub_rays - 1)) / float(sub_rays));
      }
      const Echoes e = receiver.receive(ranges, signals, beam_key(3, uint32_t(way), uint64_t(b)),
                                        scratch, noise_scale, way);
      if (e.count != 1) {
        ++other;
        continue;
      }
      const Echo& echo = e.echo[0];
      error.add(double(echo.range_m) - double(range));
      intensity.add(double(echo.intensity));
      width.add(double(echo.width_m));
      energy.add(double(echo.energy));
      error_by_intensity += (double(echo.range_m) - double(range)) * double(echo.intensity);
    }
    error_by_intensity = error_by_intensity / error.n - error.mean() * intensity.mean();
  }
};

/// Two ways of measuring the same must agree to what the numbers of beams can tell and, of moments
/// that are interpolated, to some percent of the spread.
void expect_alike(const Moments& a, const Moments& b, double step, const std::string& what) {
  const double spread = std::hypot(b.spread(), step);
  EXPECT_NEAR(a.mean(), b.mean(), 0.12 * spread + 1e-3 * std::abs(b.mean())) << what;
  EXPECT_NEAR(a.spread(), b.spread(), 0.12 * spread) << what;
}

TEST(LoneEcho, HasTheMomentsOfTheWaveformsEcho) {
  for (const std::string name :
       {"ouster-os1-64", "velodyne-hdl64e", "ibeo-lux-2010", "generic-spinning", "riegl-vz400i"}) {
    ReceiverOptions o = receiver_options(sensor::load(name));
    o.false_alarms = false;
    const Receiver receiver(o);
    for (const float ratio : {14.0f, 45.0f, 190.0f}) {
      for (const float noise_scale : {1.0f, 2.2f}) {
        const float signal = ratio * noise_scale * float(o.noise_sigma);
        if (signal > 0.8f * o.adc_most) continue;
        for (const int sub_rays : {1, 41}) {
          const std::string what =
              name + " " + std::to_string(ratio) + " " + std::to_string(sub_rays);
          const Reported fast(receiver, signal, noise_scale, Way::kFast, sub_rays);
          const Reported slow(receiver, signal, noise_scale, Way::kByWaveform, sub_rays);
          EXPECT_LE(fast.other, 2) << what;
          EXPECT_LE(slow.other, 6) << what;
          expect_alike(fast.error, slow.error, 0.3 * o.range_resolution_m, what + " range");
          expect_alike(fast.intensity, slow.intensity, 0.3 * o.intensity_resolution,
                       what + " intensity");
          expect_alike(fast.width, slow.width, 0.3 * o.width_resolution_m, what + " width");
          expect_alike(fast.energy, slow.energy, 0, what + " energy");
          EXPECT_NEAR(fast.error_by_intensity, slow.error_by_intensity,
                      0.12 * slow.error.spread() * slow.intensity.spread() + 1e-12)
              << what;
        }
      }
    }
  }
}

TEST(LoneEcho, IsDrawnOnlyWhereOneStrongReturnStandsAlone) {
  ReceiverOptions o = receiver_options(sensor::load("ouster-os1-64"));
  o.mode = ReturnMode::kAll;
  o.max_echoes = 3;
  const Receiver receiver(o);
  Waveform scratch = receiver.scratch();
  const float noise = float(o.noise_sigma);
  const auto differ = [&](std::vector<float> range, std::vector<float> signal) {
    int count = 0;
    for (uint64_t k = 0; k < 50; ++k) {
      const Echoes a = receiver.receive(range, signal, k, scratch, 1, Way::kFast);
      const Echoes b = receiver.receive(range, signal, k, scratch, 1, Way::kByWaveform);
      bool same = a.count == b.count;
      for (int e = 0; same && e < a.count; ++e) {
        same = a.echo[size_t(e)].range_m == b.echo[size_t(e)].range_m &&
               a.echo[size_t(e)].width_m == b.echo[size_t(e)].width_m;
      }
      count += !same;
    }
    return count;
  };
  EXPECT_GT(differ({30}, {60 * noise}), 40);
  EXPECT_GT(differ({30, 200}, {60 * noise, 60 * noise}), 40);  // the other is beyond the range
  EXPECT_GT(differ({30, 40}, {60 * noise, 0}), 40);
  EXPECT_EQ(differ({30, 33}, {60 * noise, 60 * noise}), 0);
  EXPECT_EQ(differ({30, 30.3f}, {60 * noise, 60 * noise}), 0);
  EXPECT_EQ(differ({30}, {float(o.detector.threshold) * noise}), 0);
  EXPECT_EQ(differ({30}, {2 * o.adc_most}), 0);
  EXPECT_EQ(differ({}, {}), 0);
}

TEST(LoneReturn, JoinsWhatLiesTogetherAndCounts) {
  const std::vector<float> range{10, 10.02f, NAN, 10.01f, INFINITY, 10, -1, 10.01f, 10, 90};
  const std::vector<float> signal{1, 2, 5, 1, 5, 0, 5, NAN, -3, 4};
  const LoneReturn r = lone_return(range, signal, 80, 0.05f);
  EXPECT_FLOAT_EQ(r.signal, 4);
  EXPECT_NEAR(r.range_m, (10 + 2 * 10.02 + 10.01) / 4, 2e-6);
  EXPECT_EQ(lone_return(range, signal, 100, 0.05f).signal, 0);
  EXPECT_EQ(lone_return(range, signal, 80, 0.01f).signal, 0);
  EXPECT_EQ(lone_return({}, {}, 80, 1).signal, 0);
}

}  // namespace
}  // namespace underbrush::radiometry
