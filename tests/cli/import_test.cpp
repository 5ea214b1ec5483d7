// Tests of `underbrush import` and `underbrush info`: counts, exit codes, and no partial outputs.
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
  // Writes the drive of a rotating 64-ring scanner in KITTI's format, through a tube around the
  // road.
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

// A tripod's scan as used in forestry has X Y Z and the number of the return within its pulse.
TEST_F(Import, ReturnsOfAPulseAreChosenByAColumn) {
  std::string csv = "X Y Z target_count target_index\n";
  for (int k = 0; k < 360; ++k) {
    const double a = k * M_PI / 180;
    const auto row = [&](double r, int index) {
      csv += std::to_string(r * std::cos(a)) + " " + std::to_string(r * std::sin(a)) + " " +
             std::to_string(r / 5) + " 2 " + std::to_string(index) + "\n";
    };
    row(5, 1);
    row(8, 2);
  }
  put_bytes(folder_ / "tripod.csv", csv);
  ASSERT_EQ(run("import tripod.csv -o log.ply"), 0) << errors();
  EXPECT_NE(bytes_of(folder_ / "stdout").find("later returns    360"), std::string::npos);
  ASSERT_EQ(run("import tripod.csv --keep target_index=1 -o log.ply --json counts.json"), 0)
      << errors();
  const Json counts = Json::parse(bytes_of(folder_ / "counts.json"));
  EXPECT_EQ(counts["hits"], 360);
  EXPECT_EQ(counts["skipped"].at("target_index is not 1 (--keep)"), 360);
  const BeamLog log = io::read_log(folder_ / "log.ply");
  EXPECT_LT(*std::max_element(log.range_m.begin(), log.range_m.end()), 6);
  // Without times and rings, packets are columns of azimuth.
  ASSERT_EQ(run("split log.ply --columns 2 --train a.ply --test b.ply"), 0) << errors();
  EXPECT_NEAR(double(io::read_log(folder_ / "a.ply").size()), 180, 4);
  EXPECT_EQ(run("import tripod.csv --keep target=1 -o bad.ply"), 3);
  EXPECT_NE(errors().find("no column target"), std::string::npos) << errors();
  for (const char* wrong : {"target_index", "target_index=", "=1", "target_index=one"}) {
    EXPECT_EQ(run(std::string("import tripod.csv -o bad.ply --keep ") + wrong), 2) << wrong;
  }
}

TEST_F(Import, BadTablesAreOneLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"1 2\n4 5\n", "line 1"},
      {"X Y\n1 2\n", "no column 'z'"},
      {"X Y Z\n1 2\n", "line 2: expected 3"},
      {"X Y Z\n1 2 many\n", "line 2: not a number: many"},
      {"", "empty"},
      {"X Y Z\n", "bad.csv"},
      {"X Y Z X\n1 2 3 4\n", "twice"}};
  for (const auto& [text, reason] : cases) {
    put_bytes(folder_ / "bad.csv", text);
    EXPECT_EQ(run("import bad.csv -o log.ply"), 3) << text;
    EXPECT_NE(errors().find(reason), std::string::npos) << text << errors();
    const std::string lines = errors();
    EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 1) << lines;
    EXPECT_FALSE(output_exists());
  }
}

TEST_F(Import, GroundIsScoredAgainstLabels) {
  // The cloud has level ground (40, road) with a box on it (50, building), and points without a
  // label (0).
  std::string points, labels;
  for (int k = 0; k < 6000; ++k) {
    const double x = 3 + 0.2 * (k % 60), y = 0.2 * (k / 60) - 10;
    const bool box = k % 60 >= 20 && k % 60 < 25 && k / 60 % 20 < 5;
    const double z = box ? 0.2 + 0.1 * (k % 7) : -1.7;
    for (const double v : {x, y, z, 0.5}) io::add(points, float(v));
    io::add(labels, uint32_t(k % 10 == 0 ? 0 : box ? 50 : 40));
  }
  put_bytes(folder_ / "scan.bin", points);
  put_bytes(folder_ / "scan.label", labels);
  ASSERT_EQ(run("import scan.bin --labels scan.label -o log.ply"), 0) << errors();
  EXPECT_EQ(io::read_log(folder_ / "log.ply").info.classes, "semantickitti");
  ASSERT_EQ(run("segment log.ply -o found.ply --json score.json"), 0) << errors();
  const Json score = Json::parse(bytes_of(folder_ / "score.json"))["ground_score"];
  EXPECT_EQ(score["unlabelled"], 600);
  EXPECT_GT(score["iou"], 0.98);
  EXPECT_GT(score["precision"], 0.98);
  EXPECT_GT(score["recall"], 0.98);
  const BeamLog found = io::read_log(folder_ / "found.ply");
  EXPECT_EQ(found.info.classes, "underbrush");
  EXPECT_EQ(std::get<std::vector<uint8_t>>(found.extra.at("class"))[0], 1);  // ground
  EXPECT_EQ(std::get<std::vector<uint16_t>>(found.extra.at("given_class"))[1], 40);
  put_bytes(folder_ / "scan.label", labels.substr(4));
  EXPECT_EQ(run("import scan.bin --labels scan.label -o log2.ply"), 3);
  EXPECT_EQ(run("import log.ply --labels scan.label -o log2.ply"), 2);
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
  // The limit of the file size acts like a full disk.
  refuses("--version; trap '' XFSZ; ulimit -f 100; " UNDERBRUSH_PROGRAM
          " import drive --frames 0:1 -o log.ply",
          4, "cannot write");
}

}  // namespace
}  // namespace underbrush
