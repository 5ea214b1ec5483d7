// Tests of the clock of a recording: rounded times are put back on it, others are left alone.
#include "underbrush/io/scan_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/io/point_times.hpp"
#include "underbrush/io/poses.hpp"

namespace underbrush::io {
namespace {

constexpr double kStart = 1317042272.3492;
constexpr double kPeriod = 0.10353;

double uniform(size_t i) { return uniform_from_bits(mix64(i)); }

std::vector<double> steady(size_t n, double period = kPeriod) {
  std::vector<double> times;
  for (size_t i = 0; i < n; ++i) times.push_back(kStart + period * double(i));
  return times;
}

// Rounds down to multiples of `step` behind an offset of 2 ms.
std::vector<double> rounded(std::vector<double> times, double step = 0.01) {
  for (double& t : times) {
    t = 1317042272.002 + std::floor((t - kStart + 0.3472) / step) * step;
  }
  return times;
}

// RMS of the differences after their mean, which no clock can tell, is taken away; s.
double rms_off(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0, squares = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i] - b[i];
  for (size_t i = 0; i < a.size(); ++i) {
    squares += std::pow(a[i] - b[i] - sum / double(a.size()), 2);
  }
  return std::sqrt(squares / double(a.size()));
}

TEST(ScanClock, RoundedTimesGoBackOnTheirLine) {
  const std::vector<double> truth = steady(80), given = rounded(truth);
  const auto clock = fit_scan_clock(given);
  ASSERT_TRUE(clock);
  EXPECT_EQ(clock->step_s, 0.01);
  EXPECT_EQ(clock->fitted, 80u);
  EXPECT_EQ(clock->kept, 0u);
  EXPECT_NEAR(clock->period_s, kPeriod, 1e-5);
  EXPECT_NEAR(clock->residual_rms_s, 0.01 / std::sqrt(12), 3e-4);
  EXPECT_GT(rms_off(given, truth), 2.5e-3);  // as they are given they lose
  EXPECT_LT(rms_off(clock->time_s, truth), 2e-4);
}

// The KITTI recordings have some times that are off the grid, and some by a whole step.
TEST(ScanClock, TimesOffTheGridDoNotMatter) {
  const std::vector<double> truth = steady(90);
  std::vector<double> given = rounded(truth);
  for (size_t i = 5; i < given.size(); i += 11) given[i] += i % 2 ? 0.001 : -0.001;
  given[40] += 0.01;
  given[63] -= 0.01;
  const auto clock = fit_scan_clock(given);
  ASSERT_TRUE(clock);
  EXPECT_EQ(clock->kept, 0u);
  EXPECT_LT(rms_off(clock->time_s, truth), 4e-4);
}

TEST(ScanClock, DroppedScansCount) {
  std::vector<double> truth = steady(100);
  for (const size_t gone : {90, 71, 70, 69, 68, 30, 12, 11})
    truth.erase(truth.begin() + long(gone));
  const auto clock = fit_scan_clock(rounded(truth));
  ASSERT_TRUE(clock);
  EXPECT_EQ(clock->fitted, truth.size());
  EXPECT_NEAR(clock->period_s, kPeriod, 1e-5);
  EXPECT_LT(rms_off(clock->time_s, truth), 3e-4);
}

TEST(ScanClock, AfterAPauseItStartsAnew) {
  std::vector<double> truth = steady(120);
  for (size_t i = 50; i < truth.size(); ++i) truth[i] += i < 55 ? 0.043 : 20.0511;
  const std::vector<double> given = rounded(truth);
  const auto clock = fit_scan_clock(given);
  ASSERT_TRUE(clock);
  EXPECT_EQ(clock->fitted, 115u);
  EXPECT_EQ(clock->kept, 5u);  // too few between two pauses
  for (size_t i = 50; i < 55; ++i) EXPECT_EQ(clock->time_s[i], given[i]);
  for (const size_t begin : {0, 55}) {
    const size_t end = begin ? 120 : 50;
    const auto part = [&](const std::vector<double>& v) {
      return std::vector<double>(v.begin() + long(begin), v.begin() + long(end));
    };
    EXPECT_LT(rms_off(part(clock->time_s), part(truth)), 4e-4);
  }
}

// A motor that warms up turns slower by 0.5 %: the clock bends with it.
TEST(ScanClock, FollowsARateThatDrifts) {
  std::vector<double> truth{kStart};
  while (truth.size() < 1500) {
    truth.push_back(truth.back() + kPeriod * (1 + 0.005 * double(truth.size()) / 1500));
  }
  const std::vector<double> given = rounded(truth);
  const auto clock = fit_scan_clock(given);
  ASSERT_TRUE(clock);
  EXPECT_EQ(clock->fitted, 1500u);
  EXPECT_GT(rms_off(given, truth), 2.5e-3);
  EXPECT_LT(rms_off(clock->time_s, truth), 1e-3);
  EXPECT_TRUE(std::is_sorted(clock->time_s.begin(), clock->time_s.end()));
}

TEST(ScanClock, OtherTimesAreLeftAlone) {
  EXPECT_FALSE(fit_scan_clock({}));
  EXPECT_FALSE(fit_scan_clock({kStart}));
  EXPECT_FALSE(fit_scan_clock(rounded(steady(7))));
  EXPECT_FALSE(fit_scan_clock(steady(200)));                 // exact
  EXPECT_FALSE(fit_scan_clock(steady(200, 0.1)));            // exact, and on a grid
  EXPECT_FALSE(fit_scan_clock(rounded(steady(200), 1e-6)));  // steps that do not matter
  // Exact times of a scanner that does not turn evenly, by a tenth of a percent and by 5 %.
  for (const double spread : {1e-3, 0.05}) {
    std::vector<double> uneven = steady(200);
    for (size_t i = 0; i < uneven.size(); ++i) {
      uneven[i] += kPeriod * spread * (uniform(i) - 0.5);
    }
    EXPECT_FALSE(fit_scan_clock(uneven)) << spread;
  }
  // Rounded times, but of scans fired at random: no clock explains them.
  std::vector<double> fired = steady(200);
  for (size_t i = 0; i < fired.size(); ++i) fired[i] += 0.03 * (uniform(i) - 0.5);
  EXPECT_FALSE(fit_scan_clock(rounded(fired)));
  EXPECT_THROW(fit_scan_clock({3, 2, 1, 4, 5, 6, 7, 8, 9}), std::invalid_argument);
}

// Poses on a straight drive whose speed changes gently, at these times.
std::vector<StampedPose> drive(const std::vector<double>& at, const std::vector<double>& labels) {
  std::vector<StampedPose> poses;
  for (size_t i = 0; i < at.size(); ++i) {
    const double t = at[i] - kStart;
    StampedPose pose;
    pose.time_s = labels[i];
    pose.world_from_sensor.translation =
        Vec3(15 * t + 2 * std::sin(t), 0.01 * (uniform(i) - 0.5), 0);
    poses.push_back(pose);
  }
  return poses;
}

TEST(ScanClock, TheMotionTellsToWhichTimesThePosesBelong) {
  const std::vector<double> truth = steady(80), given = rounded(truth);
  const auto clock = fit_scan_clock(given);
  ASSERT_TRUE(clock);
  EXPECT_TRUE(poses_follow_clock(drive(truth, given), clock->time_s));
  EXPECT_FALSE(poses_follow_clock(drive(given, given), clock->time_s));
  EXPECT_THROW(poses_follow_clock(drive(truth, given), {}), std::invalid_argument);
}

TEST(PoseColumns, AnglesAreTurnsAboutXThenYThenZ) {
  const TemporaryFolder folder;
  for (const bool radians : {false, true}) {
    const std::string unit = radians ? " [rad]" : "",
                      quarter = radians ? "1.5707963267948966" : "90";
    std::string text = "GPSTime,Easting,Northing,Height,vel_east,roll";
    text.append(unit).append(",pitch,yaw\n7,1,2,3,9,").append(quarter);
    put_bytes(folder / "p", text.append(",0,").append(quarter).append("\n"));
    const PoseList poses = read_poses(folder / "p");
    ASSERT_EQ(poses.pose.size(), 1u);
    EXPECT_EQ(poses.time_s[0], 7);
    EXPECT_LT((poses.pose[0] * Vec3(1, 0, 0) - Vec3(1, 3, 3)).norm(), 1e-9);
    EXPECT_LT((poses.pose[0] * Vec3(0, 1, 0) - Vec3(1, 2, 4)).norm(), 1e-9);
    EXPECT_EQ(poses.notes.size(), 1u);
  }
  put_bytes(folder / "p", "t,x,y,z,roll_rad,pitch_rad,yaw_rad\n7,1,2,3,0,0,1.5707963267948966\n");
  EXPECT_LT((read_poses(folder / "p").pose[0] * Vec3(1, 0, 0) - Vec3(1, 3, 3)).norm(), 1e-9);
  put_bytes(folder / "p", "t,x,y,z,roll,pitch,yaw\n7,1,2,3,0,0,1.5\n");
  EXPECT_THROW(read_poses(folder / "p"), FormatError) << "radians or degrees";
  put_bytes(folder / "p", "t,x,y,z,roll,pitch,heading\n7,1,2,3,0,0,0\n");
  EXPECT_THROW(read_poses(folder / "p"), FormatError) << "a heading turns the other way";
}

/// 101 times in even steps.
std::vector<double> even_times(double first, double last) {
  std::vector<double> out;
  for (int k = 0; k <= 100; ++k) out.push_back(first + (last - first) * k / 100);
  return out;
}

TEST(PointTimes, ThoseOfAnotherClockCountFromTheScan) {
  constexpr double kScan = 1581624663;
  for (const double first : {2263.0, 30.0, 2.0, 316000.0}) {  // Since the hour, or the week.
    for (const double unit : {1.0, 1e-6}) {
      PointTimes times(0.1);
      const auto found =
          times.seconds("f", "t", even_times(first / unit, (first + 0.1) / unit), kScan);
      EXPECT_NEAR(found.front(), kScan, 1e-6) << first;
      EXPECT_NEAR(found.back(), kScan + 0.1, 1e-6) << first;
      EXPECT_NE(times.note().find("their clock is another one"), std::string::npos);
    }
  }
  PointTimes same(0.1);
  EXPECT_NEAR(same.seconds("f", "t", even_times(kScan + 3, kScan + 3.1), kScan)[0], kScan + 3,
              1e-6);
  EXPECT_NEAR(same.seconds("f", "t", even_times(0.2, 0.3), kScan)[0], kScan + 0.2, 1e-6);
}

}  // namespace
}  // namespace underbrush::io
