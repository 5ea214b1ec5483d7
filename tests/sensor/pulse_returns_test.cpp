#include "underbrush/sensor/pulse_returns.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "underbrush/core/rng.hpp"
#include "underbrush/sensor/beams_from_scan.hpp"

namespace underbrush::sensor {
namespace {

struct Return {
  double azimuth_rad, range_m;
  int number, count;
};

PointScan scan_of(const std::vector<Return>& returns) {
  PointScan scan;
  std::vector<int32_t> number, count;
  for (const Return& r : returns) {
    scan.point.emplace_back(float(r.range_m * std::cos(r.azimuth_rad)),
                            float(r.range_m * std::sin(r.azimuth_rad)), 0);
    scan.intensity.push_back(float(100 * r.range_m));
    number.push_back(r.number);
    count.push_back(r.count);
  }
  scan.extra["return_number"] = number;
  scan.extra["number_of_returns"] = count;
  return scan;
}

const std::vector<uint8_t>& echoes(const BeamLog& log, const char* name) {
  return std::get<std::vector<uint8_t>>(log.extra.at(name));
}

BeamLog beams_of(const PointScan& scan) {
  const auto pulses = pulse_returns(scan);
  BeamCounts counts;
  BeamLog log = beams_from_scan(pulses->first, Trajectory(), {}, counts);
  insert_later_returns(*pulses, log);
  log.check();
  return log;
}

TEST(PulseReturns, JoinsTheReturnsOfEachPulseInOrderOfRangeWhereverTheyStandInTheFile) {
  std::vector<Return> returns;
  for (int k = 0; k < 200; ++k) {
    const double azimuth = 0.002 * k;
    for (int n = 1; n <= 1 + k % 4; ++n)
      returns.push_back({azimuth, 5.0 + 2 * n + k, n, 1 + k % 4});
  }
  std::vector<size_t> order(returns.size());
  std::iota(order.begin(), order.end(), size_t(0));
  Stream random(3);
  for (size_t i = order.size(); i > 1; --i) {
    std::swap(order[i - 1], order[size_t(random.uniform() * double(i))]);
  }
  std::vector<Return> mixed(order.size());
  for (size_t i = 0; i < order.size(); ++i) mixed[i] = returns[order[i]];
  const BeamLog log = beams_of(scan_of(mixed));
  ASSERT_EQ(log.size(), returns.size());
  size_t beams = 0;
  for (size_t i = 0; i < log.size(); ++i) {
    const bool first = echoes(log, kEchoColumn)[i] == 1;
    beams += first;
    EXPECT_NEAR(log.intensity[i], 100 * log.range_m[i], 0.01);
    if (first) continue;
    EXPECT_EQ(echoes(log, kEchoColumn)[i], echoes(log, kEchoColumn)[i - 1] + 1);
    EXPECT_EQ(echoes(log, kEchoesColumn)[i], echoes(log, kEchoesColumn)[i - 1]);
    EXPECT_EQ(log.direction[i], log.direction[i - 1]);
    EXPECT_NEAR(log.range_m[i] - log.range_m[i - 1], 2, 1e-4);
  }
  EXPECT_EQ(beams, 200u);
  EXPECT_EQ(log.extra.count("return_number") + log.extra.count(kPulseColumn), 0u);
}

TEST(PulseReturns, CountsALaterReturnWhoseFirstOneIsNotThere) {
  const PointScan scan =
      scan_of({{0, 5, 1, 2}, {0.00001, 7, 2, 2}, {0.3, 9, 2, 2}, {0.5, 4, 1, 1}});
  const auto pulses = pulse_returns(scan);
  EXPECT_EQ(pulses->lost, 1u);
  EXPECT_EQ(pulses->later.size(), 1u);
  const BeamLog log = beams_of(scan);
  EXPECT_EQ(log.size(), 3u);
  EXPECT_EQ(echoes(log, kEchoesColumn), (std::vector<uint8_t>{2, 2, 1}));
}

TEST(PulseReturns, TimesTellPulsesOfOneDirectionApart) {
  PointScan scan = scan_of({{0, 5, 1, 2}, {0, 6, 1, 2}, {0, 9, 2, 2}, {0, 8, 2, 2}});
  scan.time_s = {1, 2, 1, 2};
  const BeamLog log = beams_of(scan);
  EXPECT_EQ(log.time_s, (std::vector<double>{1, 1, 2, 2}));
  EXPECT_EQ(log.range_m, (std::vector<float>{5, 9, 6, 8}));
}

TEST(PulseReturns, SaysNothingOfAScanWithoutTheColumns) {
  PointScan scan = scan_of({{0, 5, 1, 1}});
  scan.extra.erase("number_of_returns");
  EXPECT_FALSE(pulse_returns(scan));
}

}  // namespace
}  // namespace underbrush::sensor
