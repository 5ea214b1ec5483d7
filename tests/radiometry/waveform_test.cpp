#include "underbrush/radiometry/waveform.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"

namespace underbrush::radiometry {
namespace {

// The reference is the sum Σ a h(r − r_i) in double precision over the whole range.
TEST(Waveform, IsTheSumOfItsReturnsEverywhere) {
  Stream random(4);
  for (const Pulse pulse : {Pulse::kGaussian, Pulse::kQSwitched}) {
    const Response h({pulse, 5e-9, 2e-9, 1e-9});
    Waveform w(h, 120);
    for (int trial = 0; trial < 20; ++trial) {  // all use the same scratch, so clear must clear
      const size_t n = 1 + random.below(41);
      std::vector<float> range(n), amplitude(n);
      double most = 0;
      for (size_t i = 0; i < n; ++i) {
        range[i] = float(random.uniform(0, 130));  // some beyond the end
        if (random.uniform() < 0.1) range[i] = INFINITY;
        if (random.uniform() < 0.1) range[i] = NAN;
        amplitude[i] = float(random.uniform(-0.2, 1));
        most += std::max(0.0f, amplitude[i]);
      }
      w.clear();
      w.add(range, amplitude);
      for (size_t k = 0; k < w.size(); ++k) {
        double sum = 0;
        for (size_t i = 0; i < n; ++i) {
          if (range[i] >= 0 && range[i] <= 120 && amplitude[i] > 0) {
            sum += double(amplitude[i]) * h.at(w.range_m(double(k)) - double(range[i]));
          }
        }
        // A place is rounded by at most 1/512 of a cell, over which h changes by at most 0.6 %.
        ASSERT_NEAR(w.samples()[k], sum, 2e-3 * most + 1e-6) << k;
      }
    }
  }
}

TEST(Waveform, EnergyIsThatOfTheReturnsWhereverTheyLie) {
  const Response h({Pulse::kGaussian, 5e-9, 0, 1e-9});
  Waveform w(h, 100);
  Stream random(8);
  std::vector<float> range(41), amplitude(41);
  for (int trial = 0; trial < 100; ++trial) {
    double expected = 0, sum = 0;
    for (size_t i = 0; i < 41; ++i) {
      range[i] = float(random.uniform(0, 100));
      amplitude[i] = float(random.uniform());
      expected += double(amplitude[i]);
    }
    w.clear();
    w.add(range, amplitude);
    for (const auto& [r, s] : table_of(w)) sum += s * w.cell_m() / h.area_m();
    EXPECT_NEAR(sum, expected, 1e-4 * expected);
  }
}

TEST(Waveform, TouchesOnlyWhatReturnsReach) {
  const Response h({Pulse::kGaussian, 5e-9, 0, 1e-9});
  Waveform w(h, 1000);
  const float range[] = {100, 100.5f, 700}, amplitude[] = {1, 1, 1};
  w.add(range, amplitude);
  int runs = 0;
  w.for_each_run([&](size_t begin, size_t end) {
    ++runs;
    EXPECT_LE(end - begin, 64u);
  });
  EXPECT_EQ(runs, 2);
  EXPECT_LE(w.touched(), 128u);
  w.clear();
  EXPECT_EQ(w.touched(), 0u);
  EXPECT_TRUE(table_of(w).empty());
}

TEST(Waveform, NoiseIsNormalFilteredByTheReceiverAndTheKeysOwn) {
  const Response h({Pulse::kGaussian, 5e-9, 2e-9, 1e-9});
  Waveform w(h, 100);
  const float range = 50, amplitude = 1e-6f;
  double n = 0, mean = 0, square = 0, fourth = 0, neighbours = 0;
  for (uint64_t beam = 0; beam < 3000; ++beam) {
    w.clear();
    w.add({&range, 1}, {&amplitude, 1});
    w.add_noise(beam_key(3, 0, beam), 2);
    const auto table = table_of(w);
    for (size_t k = 0; k < table.size(); ++k) {
      const double v = table[k].second / 2;
      ++n;
      mean += v;
      square += v * v;
      fourth += v * v * v * v;
      if (k > 0) neighbours += v * table[k - 1].second / 2;
    }
  }
  // The filter makes neighbours alike, and so the numbers that count fewer.
  double correlation = 0, alike = 0;
  const std::span<const float> filter = h.noise_filter();
  for (size_t lag = 0; lag < filter.size(); ++lag) {
    double sum = 0;
    for (size_t k = lag; k < filter.size(); ++k) sum += double(filter[k - lag] * filter[k]);
    if (lag == 0) {
      EXPECT_NEAR(sum, 1, 1e-6);
    }
    if (lag == 1) correlation = sum;
    alike += (lag == 0 ? 1 : 2) * sum;
  }
  EXPECT_GT(correlation, 0.5);
  const double sigma = std::sqrt(alike / n);
  EXPECT_NEAR(mean / n, 0, 4 * sigma);
  EXPECT_NEAR(square / n, 1, 4 * M_SQRT2 * sigma);
  EXPECT_NEAR(fourth / n, 3, 0.1);
  const double runs = 3000;  // of which each has a pair of neighbours less than samples
  EXPECT_NEAR(neighbours / (n - runs), correlation, 4 * M_SQRT2 * sigma);
}

TEST(Waveform, DigitisedIsInStepsAndCut) {
  const Response h({Pulse::kGaussian, 5e-9, 0, 1e-9});
  Waveform w(h, 100);
  const float range = 50, amplitude = 20;
  w.add({&range, 1}, {&amplitude, 1});
  const auto before = table_of(w);
  w.quantise(0.25f, 12.5f);
  const auto after = table_of(w);
  for (size_t k = 0; k < after.size(); ++k) {
    EXPECT_NEAR(after[k].second, std::min(before[k].second, 12.5), 0.125);
    EXPECT_EQ(after[k].second * 4, std::round(after[k].second * 4));
  }
}

TEST(Waveform, RefusesARangeThatIsNone) {
  const Response h({Pulse::kGaussian, 5e-9, 0, 1e-9});
  EXPECT_THROW(Waveform(h, 0), std::invalid_argument);
  EXPECT_THROW(Waveform(h, INFINITY), std::invalid_argument);
  EXPECT_THROW(Waveform(h, 1e9), std::invalid_argument);
  Waveform w(h, 10);
  const float two[] = {1, 2};
  EXPECT_THROW(w.add({two, 2}, {two, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::radiometry
