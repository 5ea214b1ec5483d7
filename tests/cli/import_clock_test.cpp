// A drive through a hall whose walls are known, with the times of its scans rounded to 10 ms as in
// KITTI: `import --deskew` puts the returns back on the walls.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "io/temporary.hpp"
#include "underbrush/io/log_file.hpp"

namespace underbrush {
namespace {

using io::bytes_of;
using io::put_bytes;
using Json = nlohmann::json;

constexpr double kPeriod = 0.1035, kSpeed = 15;         // s, m/s
constexpr double kBack = -30, kFront = 100, kSide = 8;  // m; the walls across and along the road

enum class Poses { kOfScans, kOfLabels };

class ImportClock : public testing::Test {
 protected:
  const io::TemporaryFolder folder_;

  int run(const std::string& arguments) {
    const std::string command = "cd " + folder_.path().string() + " && " UNDERBRUSH_PROGRAM " " +
                                arguments + " > stdout 2> stderr";
    return WEXITSTATUS(std::system(command.c_str()));
  }

  static double rounded(double t) { return std::floor(t * 100 + 0.35) / 100; }

  // Writes a drive of `frames` raw scans of a clockwise scanner with 64 rings at constant speed;
  // frames in `dropped` are not there, and the numbers of files close the gap. The poses are those
  // of the true instants, or of the times as they are written.
  void put_drive(int frames, const std::vector<int>& dropped, Poses kind, bool exact = false) {
    std::string poses, times;
    int written = 0;
    for (int f = 0; f < frames; ++f) {
      if (std::count(dropped.begin(), dropped.end(), f)) continue;
      const double t = 100 + f * kPeriod, label = exact ? t : rounded(t);
      std::string scan;
      for (int ring = 0; ring < 64; ++ring) {
        for (int k = 0; k < 120; ++k) add_return(scan, t, ring, k);
      }
      char name[32];
      std::snprintf(name, sizeof name, "drive/velodyne/%06d.bin", written++);
      put_bytes(folder_ / name, scan);
      const double at = kind == Poses::kOfScans ? t : label;
      poses += "1 0 0 " + std::to_string(kSpeed * (at - 100)) + " 0 1 0 0 0 0 1 0\n";
      times += std::to_string(label) + "\n";
    }
    put_bytes(folder_ / "drive/poses_velo.txt", poses);
    put_bytes(folder_ / "drive/times.txt", times);
  }

  // The return of a beam that is fired at azimuth k · 3° into the walls.
  static void add_return(std::string& scan, double t, int ring, int k) {
    const double elevation = (2.0 - 26.8 * ring / 63) * M_PI / 180;
    const double azimuth = (k * 3 + 0.5) * M_PI / 180, turned = std::remainder(azimuth, 2 * M_PI);
    const double x = kSpeed * (t - 100 - turned / (2 * M_PI) * kPeriod);
    const double cx = std::cos(azimuth), cy = std::sin(azimuth);
    const double flat = std::min((cx > 0 ? kFront - x : kBack - x) / cx, kSide / std::abs(cy));
    for (double v : {flat * cx, flat * cy, flat * std::tan(elevation), 0.5})
      io::add(scan, float(v));
  }

  // Imports the drive; returns how far the returns of the walls across the road spread about them
  // (RMS about the mean, m).
  double spread(const std::string& options) {
    EXPECT_EQ(run("import drive --deskew velodyne-hdl64e -o log.ply --json counts.json " + options),
              0)
        << bytes_of(folder_ / "stderr");
    clock_ = Json::parse(bytes_of(folder_ / "counts.json")).at("clock");
    const BeamLog log = io::read_log(folder_ / "log.ply");
    double sum = 0, squares = 0, n = 0;
    for (size_t i = 0; i < log.size(); ++i) {
      const Vec3 p = log.end_point(i);
      if (std::abs(p.y()) > kSide - 0.5) continue;
      const double off = p.x() - (p.x() > (kFront + kBack) / 2 ? kFront : kBack);
      sum += off;
      squares += off * off;
      ++n;
    }
    EXPECT_GT(n, 500);
    mean_off_ = sum / n;
    return std::sqrt(squares / n - mean_off_ * mean_off_);
  }

  Json clock_;
  double mean_off_ = 0;  // m
};

TEST_F(ImportClock, PosesOfTheScansFollowTheClock) {
  put_drive(40, {}, Poses::kOfScans);
  EXPECT_LT(spread(""), 0.002);
  EXPECT_NE(bytes_of(folder_ / "stdout").find("times rounded to 10 ms; period 103.5 ms"),
            std::string::npos);
  EXPECT_NEAR(mean_off_, 0, 0.001);
  EXPECT_EQ(clock_.at("scans_fitted"), 40);
  EXPECT_NEAR(clock_.at("period_s"), kPeriod, 2e-5);
  EXPECT_EQ(clock_.at("poses_follow"), true);
  EXPECT_GT(spread("--times-as-given"), 0.01);
  EXPECT_TRUE(clock_.is_null());
}

TEST_F(ImportClock, PosesOfTheRoundedTimesKeepThem) {
  put_drive(40, {}, Poses::kOfLabels);
  EXPECT_LT(spread(""), 0.01);
  // What all times are off by in common cannot be told: here 1.5 ms.
  EXPECT_NEAR(std::abs(mean_off_), 0.0015 * kSpeed, 0.01);
  EXPECT_EQ(clock_.at("poses_follow"), false);
  EXPECT_GT(spread("--times-as-given"), 0.04);
}

TEST_F(ImportClock, DroppedScans) {
  put_drive(50, {7, 8, 9, 20, 33}, Poses::kOfScans);
  EXPECT_LT(spread(""), 0.002);
  EXPECT_GT(spread("--times-as-given"), 0.01);
  EXPECT_EQ(clock_.is_null(), true);
}

// The clock comes from all scans, also where few are read; a scan alone has none.
TEST_F(ImportClock, FewScans) {
  put_drive(40, {}, Poses::kOfScans);
  EXPECT_LT(spread("--frames 10:15"), 0.002);
  EXPECT_EQ(clock_.at("scans_fitted"), 40);
  std::filesystem::remove_all(folder_ / "drive");
  put_drive(1, {}, Poses::kOfScans);
  EXPECT_EQ(run("import drive --deskew velodyne-hdl64e -o log.ply --json counts.json"), 0);
  EXPECT_TRUE(Json::parse(bytes_of(folder_ / "counts.json")).at("clock").is_null());
}

TEST_F(ImportClock, ExactTimesAreLeftAlone) {
  put_drive(20, {}, Poses::kOfScans, true);
  EXPECT_LT(spread(""), 0.001);
  EXPECT_TRUE(clock_.is_null());
  const BeamLog with = io::read_log(folder_ / "log.ply");
  spread("--times-as-given");
  const BeamLog without = io::read_log(folder_ / "log.ply");
  EXPECT_EQ(with.time_s, without.time_s);
  EXPECT_EQ(with.origin, without.origin);
  EXPECT_EQ(with.direction, without.direction);
  EXPECT_EQ(with.range_m, without.range_m);
}

}  // namespace
}  // namespace underbrush
