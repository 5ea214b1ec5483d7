// Tests of the range offsets of channels: those with which a log is drawn are found again, none
// are found where there are none, and a model takes them away and puts them back.
#include "underbrush/calibrate/channels.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/fit/fit.hpp"
#include "underbrush/metrics/score.hpp"
#include "underbrush/simulate/simulate.hpp"

namespace underbrush::calibrate {
namespace {

constexpr uint16_t kRings = 24;
constexpr double kNoiseM = 0.01;

double standard_normal(size_t a, size_t b) {
  return normal(mix64(a), uint32_t(b), Purpose::kNoise);
}

// Offsets with a standard deviation of 2.5 cm and a mean of 0, m.
std::vector<double> drawn_offsets() {
  std::vector<double> out;
  double mean = 0;
  for (uint16_t ring = 0; ring < kRings; ++ring) {
    out.push_back(0.025 * standard_normal(77, ring));
    mean += out.back() / kRings;
  }
  for (double& o : out) o -= mean;
  return out;
}

// The range to the nearest of the ground, the two sides of a street, and walls that stand across
// its sides at other angles; m.
double true_range(const Ray& ray) {
  double nearest = 200;
  const auto meet = [&](const Vec3& normal, double distance) {
    const double along = normal.dot(ray.direction), t = (distance - normal.dot(ray.origin)) / along;
    if (t > 0) nearest = std::min(nearest, t);
  };
  meet(Vec3::UnitZ(), -3);
  meet(Vec3::UnitX(), 9);
  meet(-Vec3::UnitX(), 7);
  meet(Vec3(0.6, 0.8, 0), 24);
  meet(Vec3(-0.5, std::sqrt(0.75), 0), 30);
  meet(-Vec3::UnitY(), 20);
  return nearest;
}

// Scans along the street; the measured range has noise and the offset of its ring.
BeamLog street(const std::vector<double>& offset, int scans = 20) {
  BeamLog log;
  log.info.sensor = "street-scanner";
  log.info.has_misses = true;
  log.resize(size_t(scans) * 600 * kRings);
  size_t i = 0;
  for (int scan = 0; scan < scans; ++scan) {
    for (int k = 0; k < 600; ++k) {
      for (uint16_t ring = 0; ring < kRings; ++ring, ++i) {
        const double azimuth = 2 * M_PI * (k + 0.37 * scan) / 600;
        const double elevation = (5 - 0.6 * ring) * M_PI / 180;
        log.origin[i] = Vec3(0.3 * std::sin(scan), 0.6 * scan, 0);
        const Vec3 d(std::cos(elevation) * std::cos(azimuth),
                     std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
        log.direction[i] = d.cast<float>();
        const double range = true_range(log.ray(i)) + kNoiseM * standard_normal(1, i) +
                             (offset.empty() ? 0 : offset[ring]);
        log.range_m[i] = range < 80 ? float(range) : kMiss;
        log.ring[i] = ring;
        log.scan[i] = uint32_t(scan);
        log.time_s[i] = scan * 0.1 + k * 1e-4;
      }
    }
  }
  return log;
}

// The error of what was found, of which the mean over the rings found cannot be told.
double rms_error(const ChannelOffsets& found, const std::vector<double>& truth) {
  double squares = 0, mean = 0;
  for (const ChannelOffset& o : found) mean += (o.range_m - truth[o.ring]) / double(found.size());
  for (const ChannelOffset& o : found) squares += std::pow(o.range_m - truth[o.ring] - mean, 2);
  return std::sqrt(squares / double(found.size()));
}

TEST(Channels, FindsTheOffsetsWithWhichALogWasDrawn) {
  const std::vector<double> truth = drawn_offsets();
  const BeamLog log = street(truth);
  MemorySource source(log);
  const ChannelOffsets found = learn_offsets(source, {});
  ASSERT_GE(found.size(), kRings - 2u);  // those at the edges see little that others see
  double mean = 0;
  for (const ChannelOffset& o : found) {
    mean += o.range_m;
    EXPECT_LT(o.standard_error_m, 0.01);
  }
  EXPECT_NEAR(mean, 0, 1e-12);
  EXPECT_LT(rms_error(found, truth), 0.006);
  EXPECT_GT(spread_of(found).sigma_m, 0.02);  // without offsets the error would be this
}

TEST(Channels, FindsNoneWhereThereAreNone) {
  const BeamLog log = street({});
  MemorySource source(log);
  EXPECT_TRUE(learn_offsets(source, {}).empty());
}

TEST(Channels, AnOffsetThatAllShareIsNotTold) {
  const BeamLog log = street(std::vector<double>(kRings, 0.05));
  MemorySource source(log);
  EXPECT_TRUE(learn_offsets(source, {}).empty());
}

TEST(Channels, ManyScansAreThinnedAndFewTellNothing) {
  const std::vector<double> truth = drawn_offsets();
  const BeamLog log = street(truth);
  MemorySource source(log, 1000);
  ChannelOptions options;
  options.most_points = log.size() / 2;
  const ChannelOffsets half = learn_offsets(source, options);
  ASSERT_GT(half.size(), kRings / 2);
  EXPECT_LT(rms_error(half, truth), 0.01);
  const BeamLog none;
  MemorySource empty(none);
  EXPECT_TRUE(learn_offsets(empty, {}).empty());
}

TEST(Channels, TheFitKeepsThemAndMakesABetterModel) {
  const std::vector<double> truth = drawn_offsets();
  const BeamLog log = street(truth, 10);
  MemorySource source(log);
  fit::FitOptions options;
  options.fitter = "hierarchical";
  options.ranges_as_given = true;
  const fit::FitResult plain = fit::fit(source, options);
  EXPECT_TRUE(plain.model.channels.empty());
  options.ranges_as_given = false;
  set_threads(1);
  const fit::FitResult one = fit::fit(source, options);
  set_threads(3);
  const fit::FitResult three = fit::fit(source, options);
  set_threads(0);
  ASSERT_FALSE(one.model.channels.empty());
  ASSERT_EQ(one.model.channels.size(), three.model.channels.size());
  for (size_t i = 0; i < one.model.channels.size(); ++i) {
    EXPECT_EQ(one.model.channels[i].range_m, three.model.channels[i].range_m);
  }
  ASSERT_EQ(one.model.ellipsoids.size(), three.model.ellipsoids.size());
  for (size_t i = 0; i < one.model.ellipsoids.size(); ++i) {
    EXPECT_EQ(one.model.ellipsoids[i].mean, three.model.ellipsoids[i].mean);
  }
  // Beams of the log, scored against each model: the corrected one is more likely.
  const auto nll = [&](const fit::FitResult& r) {
    const trace::World world(r.model);
    metrics::ScoreOptions what;
    what.world = &world;
    what.cloud = false;
    MemorySource same(log);
    return metrics::score(source, same, what).all.nll_per_beam;
  };
  EXPECT_LT(nll(one), nll(plain) - 0.3);
}

TEST(Channels, ALogThatDoesNotNameItsSensorHasNone) {
  BeamLog log = street(drawn_offsets(), 10);
  log.info.sensor.clear();
  MemorySource source(log);
  EXPECT_TRUE(fit::fit(source, fit::FitOptions()).model.channels.empty());
}

TEST(Channels, OffsetsAreOfTheSensorThatHasThem) {
  elements::Model model;
  model.sensor = "a";
  model.channels = {{1, 0.02, 0.001}, {3, -0.02, 0.001}};
  LogInfo info;
  info.sensor = "b";
  EXPECT_TRUE(model.channels_of(info).empty());
  info.sensor = "a";
  ASSERT_EQ(model.channels_of(info).size(), 2u);
  BeamLog log;
  log.resize(5);
  log.ring = {0, 1, 2, 3, 9};
  log.range_m = {5, 5, 5, 0.01f, 5};
  add_offsets(model.channels, 1, log);
  EXPECT_EQ(log.range_m[0], 5);
  EXPECT_FLOAT_EQ(log.range_m[1], 5.02f);
  EXPECT_EQ(log.range_m[2], 5);
  EXPECT_FLOAT_EQ(log.range_m[3], float(kLeastRangeM));
  EXPECT_EQ(log.range_m[4], 5);
  BeamLog miss;
  miss.resize(1);
  miss.ring = {1};
  add_offsets(model.channels, 1, miss);
  EXPECT_EQ(miss.range_m[0], kMiss);
  model.channels[1].ring = 1;
  EXPECT_THROW(model.check(), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::calibrate
