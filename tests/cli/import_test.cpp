// `underbrush import` and `underbrush info`: counts, exit codes, and nothing half-written.
#include <gtest/gtest.h>
#include <sys/wait.h>

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

class Import : public testing::Test {
 protected:
  const io::TemporaryFolder folder_;

  int run(const std::string& arguments) {
    const std::string command = "cd " + folder_.path().string() + " && " UNDERBRUSH_PROGRAM " " +
                                arguments + " > stdout 2> stderr";
    return WEXITSTATUS(std::system(command.c_str()));
  }
  std::string errors() const { return bytes_of(folder_ / "stderr"); }
  bool output_exists() const {
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      if (entry.path().filename().string().rfind("log.ply", 0) == 0) return true;
    }
    return false;
  }
  // A drive of a rotating 64-ring scanner in the manner of KITTI: a tube around the road.
  void put_drive(int frames) {
    for (int f = 0; f < frames; ++f) {
      std::string scan;
      for (int ring = 0; ring < 64; ++ring) {
        const double elevation = (2.0 - 26.8 * ring / 63) * M_PI / 180;
        for (int k = 0; k < 360; ++k) {
          if (ring < 8 && k >= 90 && k < 100) continue;  // a gap in the upper rings
          const double a = k * M_PI / 180, r = 10 + ring * 0.1;
          for (double v : {r * std::cos(elevation) * std::cos(a),
                           r * std::cos(elevation) * std::sin(a), r * std::sin(elevation), 0.5}) {
            io::add(scan, float(v));
          }
        }
      }
      char name[32];
      std::snprintf(name, sizeof name, "drive/velodyne/%06d.bin", f);
      put_bytes(folder_ / name, scan);
    }
    std::string poses, times;
    for (int f = 0; f < frames; ++f) {
      poses += "1 0 0 " + std::to_string(5000000 + f) + " 0 1 0 0 0 0 1 2\n";
      times += std::to_string(100 + 0.1 * f) + "\n";
    }
    put_bytes(folder_ / "drive/poses_velo.txt", poses);
    put_bytes(folder_ / "drive/times.txt", times);
  }
};

TEST_F(Import, KittiDriveWithDeskewAndMisses) {
  put_drive(4);
  ASSERT_EQ(run("import drive --poses drive/poses_velo.txt --deskew velodyne-hdl64e "
                "--elevation-offset-deg 0.205 --infer-misses velodyne-hdl64e --frames 1:3 "
                "-o log.ply --json counts.json"),
            0)
      << errors();
  const Json counts = Json::parse(bytes_of(folder_ / "counts.json"));
  EXPECT_EQ(counts["scans"], 2);
  EXPECT_EQ(counts["hits"], 2 * (64 * 360 - 8 * 10));
  EXPECT_GT(counts["misses_inferred"], 0);
  EXPECT_EQ(counts["misses_recorded"], 0);
  const BeamLog log = io::read_log(folder_ / "log.ply");
  EXPECT_EQ(log.size(), counts["beams"]);
  EXPECT_TRUE(log.info.deskewed);
  EXPECT_TRUE(log.info.has_misses);
  EXPECT_EQ(log.info.sensor, "velodyne-hdl64e");
  ASSERT_EQ(log.info.scans.size(), 2u);
  EXPECT_EQ(log.info.scans[0].scan, 1u);
  const auto [low, high] =
      std::minmax_element(log.origin.begin(), log.origin.end(),
                          [](const Vec3& a, const Vec3& b) { return a.x() < b.x(); });
  EXPECT_NEAR(low->x(), 5000000.5, 0.05);  // half a revolution before frame 1
  EXPECT_NEAR(high->x(), 5000002.5, 0.05);
  ASSERT_EQ(run("info log.ply --json info.json"), 0) << errors();
  const Json info = Json::parse(bytes_of(folder_ / "info.json"));
  EXPECT_EQ(info["beams"], log.size());
  EXPECT_EQ(info["rings"], 64);
  EXPECT_EQ(info["misses_inferred"], counts["misses_inferred"]);
  EXPECT_EQ(info["provenance"]["command"][1], "import");
}

TEST_F(Import, RawScansStayRaw) {
  put_drive(1);
  ASSERT_EQ(run("import drive -o log.ply"), 0) << errors();
  const BeamLog log = io::read_log(folder_ / "log.ply");
  EXPECT_FALSE(log.info.deskewed);
  EXPECT_FALSE(log.info.has_misses);
  EXPECT_NE(bytes_of(folder_ / "stdout").find("no misses"), std::string::npos);
}

TEST_F(Import, BadInputIsOneLineAndLeavesNothing) {
  put_drive(2);
  std::string scan = bytes_of(folder_ / "drive/velodyne/000001.bin");
  put_bytes(folder_ / "drive/velodyne/000001.bin", scan.substr(0, scan.size() - 3));
  const auto refuses = [&](const std::string& arguments, int code, const std::string& reason) {
    EXPECT_EQ(run(arguments), code) << arguments;
    const std::string text = errors();
    EXPECT_NE(text.find(reason), std::string::npos) << text;
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
    EXPECT_FALSE(output_exists());
  };
  refuses("import drive -o log.ply", 3, "000001.bin");
  refuses("import absent -o log.ply", 3, "absent");
  refuses("import drive --poses drive/times.txt -o log.ply", 3, "times.txt");
  refuses("import drive/velodyne/000001.bin -o log.ply", 3, "truncated");
  refuses("import drive --frames 7:9 -o log.ply", 2, "frames");
  refuses("import drive --deskew no-such-sensor -o log.ply", 2, "no-such-sensor");
  refuses("info drive/poses_velo.txt", 3, "poses_velo.txt");
  refuses("import drive --frames 0:1 -o absent/log.ply", 4, "absent/log.ply");
  std::string zeros(160, '\0');
  put_bytes(folder_ / "zeros.bin", zeros);
  refuses("import zeros.bin -o log.ply", 3, "no usable beams");
  // A full disk.
  refuses("--version; trap '' XFSZ; ulimit -f 100; " UNDERBRUSH_PROGRAM
          " import drive --frames 0:1 -o log.ply",
          4, "cannot write");
}

}  // namespace
}  // namespace underbrush
