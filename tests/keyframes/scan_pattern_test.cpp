// Tests of how sensors without a name are told apart.
#include "underbrush/keyframes/scan_pattern.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "ball_scanner.hpp"
#include "underbrush/keyframes/keyframe_cache.hpp"

namespace underbrush::keyframes {
namespace {

using test::kDrive;
using test::kRings;

BeamLog unnamed(const std::vector<double>& at, uint32_t first_scan) {
  BeamLog log = test::scanned(at, first_scan, 0.7);
  log.info.sensor.clear();
  return log;
}

const elements::Model& model_of_unnamed() {
  static const elements::Model model = test::fitted(unnamed(kDrive, 0), 1);
  return model;
}

bool serves(const elements::Model& model, const BeamLog& log) {
  MemorySource source(log, 5000);
  return KeyframeCache::serves(model, source);
}

/// The beams of a log for whose number `keep` holds.
BeamLog some(const BeamLog& log, const std::function<bool(size_t)>& keep) {
  BeamLog out = log.like();
  for (size_t i = 0; i < log.size(); ++i) {
    if (keep(i)) out.append(log, i);
  }
  return out;
}

/// Changes the elevation (rad) of each beam, seen from the sensor.
void set_elevations(BeamLog& log, const std::function<double(double)>& changed) {
  for (Vec3f& d : log.direction) {
    const double azimuth = std::atan2(double(d.y()), double(d.x()));
    const double to = changed(std::asin(double(d.z())));
    d = Vec3(std::cos(to) * std::cos(azimuth), std::cos(to) * std::sin(azimuth), std::sin(to))
            .cast<float>();
  }
}

TEST(ScanPattern, AnUnnamedLogOfTheSameSensorIsServed) {
  const BeamLog log = unnamed({1, 3.3, 30}, 100);
  EXPECT_TRUE(serves(model_of_unnamed(), log));
  EXPECT_TRUE(serves(model_of_unnamed(), some(log, [&](size_t i) { return log.scan[i] == 102; })));
  EXPECT_TRUE(serves(model_of_unnamed(), some(log, [&](size_t i) { return i / kRings % 7 == 0; })));
  EXPECT_TRUE(serves(model_of_unnamed(), some(log, [&](size_t i) { return log.ring[i] % 3 > 0; })));
  EXPECT_TRUE(serves(model_of_unnamed(), some(log, [&](size_t i) { return log.is_hit(i); })));
  EXPECT_TRUE(serves(model_of_unnamed(), log.like())) << "an empty log has no beams of another";
}

TEST(ScanPattern, AnUnnamedLogOfAnotherSensorIsRefused) {
  const BeamLog same = unnamed({1, 3.3}, 100);
  BeamLog other = same;
  set_elevations(other, [](double e) { return 1.3 * e; });
  EXPECT_FALSE(serves(model_of_unnamed(), other)) << "a taller field of view";
  other = same;
  set_elevations(other, [](double e) { return e + 0.7 * M_PI / 180; });
  EXPECT_FALSE(serves(model_of_unnamed(), other)) << "rows between those of the model";
  other = some(same, [&](size_t i) { return same.ring[i] % 2 == 0; });
  for (uint16_t& ring : other.ring) ring = uint16_t(ring / 2);
  EXPECT_FALSE(serves(model_of_unnamed(), other)) << "half as many channels";
  other = same;
  std::fill(other.ring.begin(), other.ring.end(), uint16_t(0));
  EXPECT_FALSE(serves(model_of_unnamed(), other)) << "no channels";
  other = same;
  other.info.max_range_m = 8;
  for (float& range : other.range_m) range = range < 8 ? range : kMiss;
  EXPECT_FALSE(serves(model_of_unnamed(), other)) << "a shorter reach";
  other = same;
  other.info.sensor = "velodyne-vlp16";
  EXPECT_FALSE(serves(model_of_unnamed(), other)) << "a name";
}

TEST(ScanPattern, NamesDecideWhereThereAreAny) {
  BeamLog other = test::scanned({1}, 100);
  set_elevations(other, [](double e) { return 1.3 * e; });
  EXPECT_TRUE(serves(test::fitted(test::scanned(kDrive, 0, 0.7), 1), other));
}

TEST(ScanPattern, SensorsWithoutChannelsAreComparedByTheirField) {
  const auto without_channels = [](BeamLog log) {
    std::fill(log.ring.begin(), log.ring.end(), uint16_t(0));
    return log;
  };
  const elements::Model model = test::fitted(without_channels(unnamed(kDrive, 0)), 1);
  ASSERT_TRUE(model.keyframes);
  const BeamLog same = without_channels(unnamed({1, 3.3}, 100));
  EXPECT_TRUE(serves(model, same));
  EXPECT_FALSE(serves(model, unnamed({1, 3.3}, 100))) << "channels";
  BeamLog other = same;
  set_elevations(other, [](double e) { return 2 * e; });
  EXPECT_FALSE(serves(model, other));
}

}  // namespace
}  // namespace underbrush::keyframes
