#include "underbrush/io/input.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "formats.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/export.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/io/poses.hpp"
#include "underbrush/io/table.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace {

const std::string kIdentity = "1 0 0 0 0 1 0 0 0 0 1 0\n";
std::string kitti_poses(int n) {
  std::string s;
  for (int i = 0; i < n; ++i) s += "1 0 0 " + std::to_string(i) + " 0 1 0 0 0 0 1 0\n";
  return s;
}

void put_scans(const std::filesystem::path& folder, std::initializer_list<const char*> names) {
  for (const char* name : names) put_bytes(folder / name, sample_bin());
}

TEST(Poses, ToldApartByColumns) {
  const TemporaryFolder folder;
  put_bytes(folder / "a", "# t x y z q\n1 2 3 4 0 0 0 1\n2 2 3 5 0 0 1 0\n");
  const PoseList tum = read_poses(folder / "a");
  EXPECT_EQ(tum.time_s, (std::vector<double>{1, 2}));
  EXPECT_EQ(tum.pose[1].translation, Vec3(2, 3, 5));
  EXPECT_NEAR((tum.pose[1] * Vec3(1, 0, 0) - Vec3(1, 3, 5)).norm(), 0, 1e-12);
  put_bytes(folder / "b", "1 0 0 7 0 0 -1 8 0 1 0 9\n");
  const PoseList kitti = read_poses(folder / "b");
  EXPECT_TRUE(kitti.time_s.empty());
  EXPECT_NEAR((kitti.pose[0] * Vec3(0, 1, 0) - Vec3(7, 8, 10)).norm(), 0, 1e-12);
  put_bytes(folder / "c", "stamp, T00, T01\n5, 1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 3\n");
  EXPECT_EQ(read_poses(folder / "c").pose[0].translation, Vec3(1, 2, 3));
}

TEST(Poses, BadOnesAreRefused) {
  const TemporaryFolder folder;
  for (const char* bad : {"", "# nothing\n", "1 2 3\n", "1 2 3 4 0 0 0 1.1\n",
                          "1 2 3 nan 0 0 0 1\n", "1 2 3 4 0 0 0 1\n1 2 3 4 0 0 0 1\n",
                          "1 2 3 4 0 0 0 1\n2 2 3 4 0 0 0\n", "1 0 0 7 0 2 0 8 0 0 1 9\n",
                          "1 0 0 7 0 1 0 8 0 0 -1 9\n", "1 2 x\n", "1 2 3 4 0 0 0 1\nabc\n"}) {
    put_bytes(folder / "p", bad);
    EXPECT_THROW(read_poses(folder / "p"), FormatError) << bad;
  }
  for (const char* bad : {"1\n1\n", "2\n1\n", "1 2\n", "inf\n"}) {
    put_bytes(folder / "t", bad);
    EXPECT_THROW(read_times(folder / "t"), FormatError) << bad;
  }
  EXPECT_THROW(read_poses(folder.path()), FormatError);
}

/// What the reason of the refusal of `read` is.
template <typename Read>
std::string reason_of(const Read& read) {
  try {
    read();
  } catch (const FormatError& e) {
    return e.reason();
  }
  return "";
}

TEST(Poses, TimesThatAreAllTheSameAreNamed) {
  const TemporaryFolder folder;
  put_bytes(folder / "p", "0 2 3 4 0 0 0 1\n0 2 3 5 0 0 0 1\n0 2 3 6 0 0 0 1\n");
  EXPECT_EQ(reason_of([&] { read_poses(folder / "p"); }), "all 3 times are 0");
  put_bytes(folder / "t", "1600000000\n1600000000\n");
  EXPECT_EQ(reason_of([&] { read_times(folder / "t"); }), "all 2 times are 1600000000");
  put_bytes(folder / "t", "0\n1\n1\n");
  EXPECT_EQ(reason_of([&] { read_times(folder / "t"); }), "the same time twice");
}

TEST(Poses, TheirTimesAreNamedWhereTheyMissAScan) {
  const TemporaryFolder folder;
  const auto reason = [&](const char* times, double first_s) {
    put_scans(folder / "velodyne", {"000000.bin", "000001.bin"});
    put_bytes(folder / "times.txt", times);
    std::string poses;
    for (int k = 0; k < 5; ++k) {
      char row[80];
      std::snprintf(row, sizeof row, "%.1f %d 0 0 0 0 0 1\n", first_s + k, k);
      poses += row;
    }
    put_bytes(folder / "poses.txt", poses);
    InputOptions options;
    options.poses = folder / "poses.txt";
    return reason_of([&] { open_input(folder.path(), options); });
  };
  // 2020-09-13 12:26:40 UTC is second 44818 of its GPS week, which is ahead by 18 leap seconds.
  const char* dates = "1600000000\n1600000001\n";
  EXPECT_EQ(reason(dates, 44816),
            "no pose for scan 000000.bin: the times of the poses go from 44816.000 to 44820.000 s; "
            "they are seconds of the GPS week, the scans' are dates");
  EXPECT_NE(
      reason(dates, 0).find("from 0.000 to 4.000 s; they may be seconds of the GPS week or of "
                            "a clock that starts at zero"),
      std::string::npos);
  EXPECT_NE(reason("1\n2\n", 1600000000).find("they are dates, the scans' may be"),
            std::string::npos);
  EXPECT_EQ(reason("1\n2\n", 7).find(';'), std::string::npos);
}

TEST(Text, DatesAreUtc) {
  EXPECT_EQ(time_of_date("1970-01-01 00:00:00.5"), 0.5);
  EXPECT_NEAR(*time_of_date("2011-09-26 13:02:25.964389445"), 1317042145.964389445, 1e-6);
  EXPECT_EQ(*time_of_date("2000-03-01 00:00:00") - *time_of_date("2000-02-28 00:00:00"), 172800);
  EXPECT_FALSE(time_of_date("2011-13-26 13:02:25"));
  EXPECT_FALSE(time_of_date("soon"));
}

TEST(Input, KittiFolderGoesByFrameNumber) {
  const TemporaryFolder folder;
  put_scans(folder / "velodyne", {"000002.bin", "000005.bin", "000006.bin"});
  put_bytes(folder / "poses_velo.txt", kitti_poses(7));
  put_bytes(folder / "times.txt", "10\n11\n12\n13\n14\n15\n16\n");
  Input all = open_input(folder.path());
  EXPECT_EQ(all.format, "kitti");
  EXPECT_FALSE(all.compensated);
  ASSERT_EQ(all.scans->size(), 3u);
  const PointScan scan = all.scans->read(1);
  EXPECT_EQ(scan.info.scan, 5u);
  EXPECT_EQ(scan.info.time_s, 15);
  EXPECT_EQ(scan.info.world_from_sensor.translation.x(), 5);
  EXPECT_EQ(all.scans->trajectory().poses().size(), 7u);
  EXPECT_EQ(scan.size(), kSample.size());
  InputOptions options;
  options.frames = frames_from_text("2:6:3");
  EXPECT_EQ(open_input(folder.path(), options).scans->size(), 2u);
  options.frames = frames_from_text("50:");
  EXPECT_THROW(open_input(folder.path(), options), std::invalid_argument);
}

TEST(Input, MissingPosesAndTimesAreNamed) {
  const TemporaryFolder folder;
  put_scans(folder / "velodyne", {"000000.bin", "000003.bin"});
  EXPECT_THROW(open_input(folder.path()), FormatError);
  put_bytes(folder / "poses_velo.txt", kitti_poses(3));
  try {
    open_input(folder.path());
    ADD_FAILURE();
  } catch (const FormatError& e) {
    EXPECT_NE(std::string(e.what()).find("no pose for scan 000003.bin"), std::string::npos);
  }
  put_bytes(folder / "poses_velo.txt", kitti_poses(4));
  EXPECT_EQ(open_input(folder.path()).notes.size(), 1u);  // the note says that times are assumed
  put_bytes(folder / "times.txt", "1\n2\n");
  EXPECT_THROW(open_input(folder.path()), FormatError);
  EXPECT_THROW(open_input(folder / "absent"), FormatError);
}

TEST(Input, OdometryPosesMoveToTheVelodyneAndLabelsStay) {
  const TemporaryFolder folder;
  put_scans(folder / "velodyne", {"000000.bin", "000001.bin"});
  // The camera has x right, y down and z forward, and is 0.5 m in front of the velodyne.
  put_bytes(folder / "calib.txt", "P0: 1 2\nTr: 0 -1 0 0 0 0 -1 0 1 0 0 -0.5\n");
  // rotated to the right
  put_bytes(folder / "poses.txt", kIdentity + "0 0 1 0 0 1 0 0 -1 0 0 2\n");
  std::string labels;
  for (uint32_t i = 0; i < 5; ++i) add(labels, (i + 7) << 16 | (70 + i));
  put_bytes(folder / "labels" / "000000.label", labels);
  put_bytes(folder / "labels" / "000001.label", labels);
  Input input = open_input(folder.path());
  EXPECT_EQ(input.format, "kitti-odometry");
  EXPECT_TRUE(input.compensated);
  const PointScan scan = input.scans->read(1);
  const Pose& pose = scan.info.world_from_sensor;
  // The camera is at x = 0.5 + 2 and looks to −y; the velodyne is 0.5 m behind it.
  EXPECT_NEAR((pose.translation - Vec3(2.5, 0.5, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR((pose.rotation * Vec3::UnitX() - Vec3(0, -1, 0)).norm(), 0, 1e-9);
  EXPECT_EQ(std::get<std::vector<uint16_t>>(scan.extra.at("class"))[2], 72);
  EXPECT_EQ(std::get<std::vector<uint16_t>>(scan.extra.at("instance"))[2], 9);
  put_bytes(folder / "labels" / "000001.label", labels.substr(4));
  EXPECT_THROW(input.scans->read(1), FormatError);
  InputOptions options;
  options.poses = folder / "poses.txt";
  const std::vector<std::string> notes = open_input(folder.path(), options).notes;
  EXPECT_TRUE(std::ranges::any_of(
      notes, [](const std::string& note) { return note.find("--format kitti") != note.npos; }));
}

TEST(Input, KittiRawTakesOxtsPoses) {
  const TemporaryFolder folder;
  put_scans(folder / "d" / "velodyne_points" / "data", {"0000000000.bin", "0000000001.bin"});
  put_bytes(folder / "d" / "velodyne_points" / "timestamps.txt",
            "2011-09-26 13:02:25.900000000\n2011-09-26 13:02:26.000000000\n");
  put_bytes(folder / "d" / "oxts" / "timestamps.txt",
            "2011-09-26 13:02:25.900000000\n2011-09-26 13:02:26.000000000\n");
  put_bytes(folder / "d" / "oxts" / "data" / "0000000000.txt", "49.0 8.4 100 0 0 0 1 2 3\n");
  put_bytes(folder / "d" / "oxts" / "data" / "0000000001.txt",
            "49.0 8.40001 101 0 0 1.5707963267948966 1 2 3\n");
  put_bytes(folder / "calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: -0.8 0 0\n");
  Input input = open_input(folder / "d");
  EXPECT_EQ(input.format, "kitti-raw");
  EXPECT_TRUE(input.notes.empty());
  const Pose first = input.scans->read(0).info.world_from_sensor;
  const Pose second = input.scans->read(1).info.world_from_sensor;
  EXPECT_NEAR((first.translation - Vec3(0.8, 0, 0)).norm(), 0, 1e-9);
  const double east = std::cos(49 * M_PI / 180) * 6378137 * 1e-5 * M_PI / 180;
  EXPECT_NEAR((second.translation - Vec3(east, 0.8, 1)).norm(), 0, 1e-6);
  for (const char* numbers :
       {"49.0 1e308 0 0 0 0", "49 8 1e308 0 0 0", "49 8 0 0 0 1e300", "49 8"}) {
    put_bytes(folder / "d" / "oxts" / "data" / "0000000001.txt", numbers);
    EXPECT_THROW(open_input(folder / "d"), FormatError) << numbers;
  }
}

/// Makes a KITTI raw drive of scans 0 and 2, whose INS is 1 m higher each frame.
void put_drive_without_scan_1(const TemporaryFolder& folder) {
  put_scans(folder / "velodyne_points" / "data", {"0000000000.bin", "0000000002.bin"});
  for (int k = 0; k < 3; ++k) {
    put_bytes(folder / "oxts" / "data" / ("000000000" + std::to_string(k) + ".txt"),
              "49.0 8.4 " + std::to_string(k) + " 0 0 0\n");
  }
}

TEST(Input, ABlankLineOfKittiRawTimesIsAMissingScan) {
  const TemporaryFolder folder;
  put_drive_without_scan_1(folder);
  put_bytes(folder / "velodyne_points" / "timestamps.txt",
            "2011-09-26 13:02:25.9\n\n2011-09-26 13:02:26.1\n");
  put_bytes(folder / "oxts" / "timestamps.txt",
            "2011-09-26 13:02:25.9\n2011-09-26 13:02:26.0\n2011-09-26 13:02:26.1\n");
  const ScanInfo last = open_input(folder.path()).scans->read(1).info;
  EXPECT_NEAR(last.world_from_sensor.translation.z(), 2, 1e-6);
  put_bytes(folder / "velodyne_points" / "timestamps.txt", "\n2011-09-26 13:02:26.1\n");
  EXPECT_THROW(open_input(folder.path()), FormatError);
}

TEST(Input, KittiRawPosesHaveTheNumbersOfTheirFiles) {
  const TemporaryFolder folder;
  put_drive_without_scan_1(folder);
  EXPECT_NEAR(open_input(folder.path()).scans->read(1).info.world_from_sensor.translation.z(), 2,
              1e-9);
  std::filesystem::remove(folder / "oxts" / "data" / "0000000001.txt");
  put_bytes(folder / "oxts" / "data" / "0000000003.txt", "49.0 8.4 3 0 0 0\n");
  EXPECT_THROW(open_input(folder.path()), FormatError);  // the second file is no pose of scan 1
  const std::string dates =
      "2011-09-26 13:02:25.9\n2011-09-26 13:02:26.0\n2011-09-26 13:02:26.1\n"
      "2011-09-26 13:02:26.2\n";
  put_bytes(folder / "velodyne_points" / "timestamps.txt", dates);
  put_bytes(folder / "oxts" / "timestamps.txt", dates);
  EXPECT_NEAR(open_input(folder.path()).scans->read(1).info.world_from_sensor.translation.z(), 2,
              1e-6);
}

TEST(Input, DegreesOfKittiRawAreAskedAbout) {
  const TemporaryFolder folder;
  put_drive_without_scan_1(folder);
  put_bytes(folder / "oxts" / "data" / "0000000002.txt", "49.0 8.4 2 1.5 0.5 20\n");
  try {
    open_input(folder.path());
    ADD_FAILURE();
  } catch (const FormatError& e) {
    EXPECT_NE(std::string(e.what()).find("are they in degrees?"), std::string::npos) << e.what();
  }
}

TEST(Input, FolderOfScansMatchedByTime) {
  const TemporaryFolder folder;
  for (const char* name : {"100_500000000.pcd", "101_000000000.pcd"}) {
    put_bytes(folder / "s" / (std::string("1000000") + name), sample_pcd());
  }
  put_bytes(folder / "p.txt",
            "1000000100 0 0 0 0 0 0 1\n1000000102 4 0 0 0 0 0 1\n1000000101 2 0 0 0 0 0 1\n");
  InputOptions options;
  options.poses = folder / "p.txt";
  Input input = open_input(folder / "s", options);
  EXPECT_EQ(input.format, "folder");
  ASSERT_EQ(input.notes.size(), 1u);  // the note says that files were sorted
  EXPECT_NEAR(input.scans->read(0).info.world_from_sensor.translation.x(), 1, 1e-6);
  EXPECT_NEAR(input.scans->read(0).time_s[1], 1000000100.5 + 1e-7, 1e-9);
  put_bytes(folder / "s" / "1000000200_0.pcd", sample_pcd());
  EXPECT_THROW(open_input(folder / "s", options), FormatError);
}

TEST(Input, FormatsAreToldByTheirLook) {
  const TemporaryFolder folder;
  put_bytes(folder / "a.ply", sample_ply());
  EXPECT_EQ(open_input(folder / "a.ply").format, "scan");
  put_bytes(folder / "a.xyz", "x y z\n1 2 3\n");
  EXPECT_TRUE(open_input(folder / "a.xyz").scans);
  put_bytes(folder / "b.csv", "x,y,z,ox,oy,oz\n1,2,3,1,2,0\n");
  EXPECT_TRUE(open_input(folder / "b.csv").beams);
  put_bytes(folder / "c.foo", "x");
  EXPECT_THROW(open_input(folder / "c.foo"), FormatError);
  InputOptions options;
  options.format = "las";
  EXPECT_THROW(open_input(folder / "a.ply", options), std::invalid_argument);
}

TEST(Input, FrameRanges) {
  EXPECT_TRUE(frames_from_text("2:4").has(3));
  EXPECT_FALSE(frames_from_text("2:4").has(4));
  EXPECT_TRUE(frames_from_text(":4").has(0));
  EXPECT_FALSE(frames_from_text("1::2").has(2));
  for (const char* bad : {"", "3", "a:b", "1:2:3:4", "4:2", "1:9:0", "-1:4"}) {
    EXPECT_THROW(frames_from_text(bad), std::invalid_argument) << bad;
  }
}

BeamLog small_log() {
  BeamLog log;
  log.resize(4);
  log.info.max_range_m = 50;
  log.info.has_misses = true;
  log.extra["class"] = std::vector<uint16_t>{1, 2, 3, 4};
  for (size_t i = 0; i < 4; ++i) {
    log.origin[i] = Vec3(5e6 + double(i), 2, 3);
    log.direction[i] = i % 2 ? Vec3f(0, 0.6f, 0.8f) : Vec3f(1, 0, 0);
    log.time_s[i] = 1.3e9 + double(i) / 8;
    log.scan[i] = uint32_t(3 + i / 2);
    log.ring[i] = uint16_t(i);
  }
  log.range_m = {4, kMiss, 8, 2};
  log.intensity = {0.25f, 0, 0.5f, 1};
  for (uint32_t s = 3; s < 5; ++s) {
    log.info.scans.push_back({s, double(s), {Eigen::Quaterniond::Identity(), Vec3(5e6, 0, 0)}});
  }
  return log;
}

TEST(Export, CsvComesBack) {
  const TemporaryFolder folder;
  const BeamLog log = small_log();
  export_log(folder / "a.csv", log);
  Input input = open_input(folder / "a.csv");
  BeamLog back;
  ASSERT_TRUE(input.beams->next(back));
  EXPECT_EQ(back.origin, log.origin);
  EXPECT_EQ(back.time_s, log.time_s);
  EXPECT_EQ(back.intensity, log.intensity);
  EXPECT_EQ(back.scan, log.scan);
  EXPECT_EQ(back.ring, log.ring);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(back.is_hit(i), log.is_hit(i));
    EXPECT_LT((back.end_point(i) - log.end_point(i)).norm(), 1e-5);
  }
  EXPECT_EQ(back.extra.count("class"), 1u);
}

TEST(Export, PcdHoldsTheHits) {
  const TemporaryFolder folder;
  const BeamLog log = small_log();
  export_log(folder / "a.pcd", log);
  const Table table = read_pcd(folder / "a.pcd");
  ASSERT_EQ(table.size(), 3u);
  EXPECT_EQ(std::get<std::vector<double>>(*table.find({"x"}))[1], log.end_point(2).x());
  EXPECT_EQ(std::get<std::vector<uint16_t>>(*table.find({"ring"}))[2], 3);
}

TEST(Export, KittiFolderComesBack) {
  const TemporaryFolder folder;
  const BeamLog log = small_log();
  export_log(folder / "k", log);
  Input input = open_input(folder / "k");
  EXPECT_EQ(input.format, "kitti");
  ASSERT_EQ(input.scans->size(), 2u);
  const PointScan scan = input.scans->read(1);
  ASSERT_EQ(scan.size(), 2u);
  EXPECT_EQ(scan.info.time_s, 4);
  const Vec3 end = scan.info.world_from_sensor * scan.point[0].cast<double>();
  EXPECT_LT((end - log.end_point(2)).norm(), 1e-5);
  BeamLog lost = log;
  lost.info.scans.pop_back();
  EXPECT_THROW(export_log(folder / "l", lost), std::invalid_argument);
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(Input, ModelsAndScenesAreNoLogs) {
  const TemporaryFolder folder;
  for (const std::string kind : {"model", "scene"}) {
    put_bytes(folder / kind / (kind + ".json"), "{}");
    put_bytes(folder / kind / "ground.ply", "ply");
    try {
      open_input(folder / kind);
      FAIL() << kind;
    } catch (const FormatError& error) {
      EXPECT_NE(std::string(error.what()).find("is a " + kind + ", expected a log"),
                std::string::npos)
          << error.what();
    }
  }
}

}  // namespace
}  // namespace underbrush::io
