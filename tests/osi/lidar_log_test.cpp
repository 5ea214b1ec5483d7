#include "underbrush/osi/lidar_log.hpp"

#include <gtest/gtest.h>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/osi/objects.hpp"

namespace underbrush {
namespace {

BeamLog random_scan(const Pose& pose, size_t beams) {
  Stream random(7);
  BeamLog log;
  auto& echo = log.extra[kEchoColumn].emplace<std::vector<uint8_t>>();
  auto& echoes = log.extra[kEchoesColumn].emplace<std::vector<uint8_t>>();
  for (size_t b = 0; b < beams; ++b) {
    const uint64_t count = random.below(4);
    const double azimuth = random.uniform(-3, 3), elevation = random.uniform(-0.4, 0.2);
    const Vec3 d =
        pose.rotation * Vec3(std::cos(azimuth) * std::cos(elevation),
                             std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
    double range = 1;
    for (uint64_t k = 0; k < std::max<uint64_t>(count, 1); ++k) {
      const size_t row = log.size();
      log.resize(row + 1);
      log.origin[row] = pose.translation;
      log.direction[row] = d.cast<float>();
      log.time_s[row] = 5 + 1e-4 * double(b);
      log.scan[row] = 3;
      echo[row] = count ? uint8_t(k + 1) : 0;
      echoes[row] = uint8_t(count);
      if (!count) continue;
      range += random.uniform(1, 30);
      log.range_m[row] = float(range);
      log.intensity[row] = float(random.below(256));
    }
  }
  return log;
}

TEST(LidarLog, SurvivesARoundTrip) {
  Pose pose;
  pose.translation = Vec3(500, -20, 3);
  pose.rotation = osi::rotation_of({0.02, -0.05, 1.2});
  const BeamLog log = random_scan(pose, 200);
  osi::SensorView view = osi::view_of(log, {3, 5, pose});
  view.truth = osi::ground_truth_of({}, pose, 5);
  view.host_vehicle_id = osi::kHostId;
  EXPECT_EQ(view.lidar[0].configuration->beams, 200u);
  EXPECT_EQ(view.lidar[0].reflections.size(), 600u);
  BeamLog back;
  osi::append_beams(view, 3, {}, back);
  ASSERT_EQ(back.size(), log.size());
  for (size_t i = 0; i < log.size(); ++i) {
    EXPECT_EQ(back.is_hit(i), log.is_hit(i));
    EXPECT_LT((back.origin[i] - log.origin[i]).norm(), 1e-6);
    EXPECT_LT((back.direction[i] - log.direction[i]).norm(), 1e-5);
    EXPECT_NEAR(back.time_s[i], log.time_s[i], 1e-6);
    EXPECT_EQ(back.scan[i], 3u);
    if (!log.is_hit(i)) continue;
    EXPECT_NEAR(back.range_m[i], log.range_m[i], 1e-4);
    EXPECT_NEAR(back.intensity[i], log.intensity[i], 1e-3);
  }
  EXPECT_EQ(back.extra.at(kEchoColumn), log.extra.at(kEchoColumn));
  EXPECT_EQ(back.extra.at(kEchoesColumn), log.extra.at(kEchoesColumn));
  EXPECT_EQ(back.info.scans.size(), 1u);
}

TEST(LidarLog, AWrongNumberOfReflectionsIsRefused) {
  osi::SensorView view = osi::view_of(random_scan({}, 5), {3, 5, {}});
  view.lidar[0].reflections.pop_back();
  BeamLog log;
  EXPECT_THROW(osi::append_beams(view, 0, {}, log), DataError);
}

}  // namespace
}  // namespace underbrush
