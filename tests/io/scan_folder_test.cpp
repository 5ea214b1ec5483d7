#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>

#include "formats.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/input.hpp"
#include "underbrush/io/pose_gaps.hpp"
#include "underbrush/io/scan_names.hpp"

namespace underbrush::io {
namespace {

std::string kitti_rows(int n) {
  std::string s;
  for (int i = 0; i < n; ++i) s += "1 0 0 " + std::to_string(i) + " 0 1 0 0 0 0 1 0\n";
  return s;
}

/// Poses at these times, whose x is 10 times the time since the first one.
std::string tum_rows(const std::vector<double>& times) {
  std::ostringstream s;
  s.precision(17);
  for (const double t : times) s << t << " " << 10 * (t - times[0]) << " 0 0 0 0 0 1\n";
  return s.str();
}

void put_clouds(const std::filesystem::path& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    put_bytes(folder / name, name.ends_with(".pcd") ? sample_pcd() : sample_bin());
  }
}

/// The x of the poses of all scans.
std::vector<double> places(const Input& input) {
  std::vector<double> x;
  for (const ScanInfo& scan : input.scan_infos) x.push_back(scan.world_from_sensor.translation.x());
  return x;
}

bool notes_have(const Input& input, const std::string& words) {
  return std::any_of(input.notes.begin(), input.notes.end(),
                     [&](const auto& note) { return note.find(words) != std::string::npos; });
}

std::vector<std::string> names_in_order(const std::filesystem::path& folder) {
  std::vector<std::string> notes, names;
  for (const ScanFile& file : list_scans(folder, notes)) {
    names.push_back(file.path.filename().string());
  }
  return names;
}

TEST(ScanFolder, NumbersStayBesideForeignFiles) {
  for (const char* foreign : {"map.pcd", "000101 - Copy.bin", "calib.npy", "000100_old.bin"}) {
    const TemporaryFolder folder;
    put_clouds(folder.path(), {"000100.bin", "000101.bin", "000103.bin", foreign});
    put_bytes(folder / "poses.txt", kitti_rows(200));
    const Input input = open_input(folder.path());
    EXPECT_EQ(places(input), (std::vector<double>{100, 101, 103})) << foreign;
    EXPECT_TRUE(notes_have(input, foreign));
  }
  const TemporaryFolder folder;
  put_clouds(folder.path(), {"000100.bin", "000101.bin", "a.bin", "b.bin"});
  put_bytes(folder / "poses.txt", kitti_rows(200));
  EXPECT_THROW(open_input(folder.path()), FormatError) << "which are the scans?";
}

TEST(ScanFolder, TimesStayBesideForeignFilesAndAnyNamesAreTakenTogether) {
  const TemporaryFolder folder;
  put_clouds(folder / "t", {"1600000000_100000000.bin", "1600000000_200000000.bin", "map.pcd"});
  put_bytes(folder / "t" / "poses.txt", tum_rows({1.6e9, 1.6e9 + 1}));
  EXPECT_NEAR(places(open_input(folder / "t"))[1], 2, 1e-5);
  put_clouds(folder / "n", {"left.bin", "right.bin", "top1.bin"});
  EXPECT_EQ(names_in_order(folder / "n").size(), 3u);
  put_clouds(folder / "m", {"a1.bin", "a2.bin", "a3.bin", "calib.bin"});
  EXPECT_EQ(names_in_order(folder / "m").size(), 3u);
}

TEST(ScanFolder, OrderIsThatOfTheNumbers) {
  const TemporaryFolder folder;
  const std::vector<std::string> names{"cloud_1.pcd",  "cloud_2.pcd",  "cloud_9.pcd",
                                       "cloud_10.pcd", "cloud_12.pcd", "cloud_100.pcd"};
  put_clouds(folder / "a", names);
  EXPECT_EQ(names_in_order(folder / "a"), names);
  const std::vector<std::string> fractions{"0.05.pcd", "0.1.pcd", "0.15.pcd", "2.0.pcd",
                                           "10.5.pcd"};
  put_clouds(folder / "b", fractions);
  EXPECT_EQ(names_in_order(folder / "b"), fractions);
}

TEST(ScanFolder, NumbersInNamesCountTheRowsWhereThereAreMore) {
  const auto found = [](const std::vector<std::string>& names, int rows) {
    const TemporaryFolder folder;
    put_clouds(folder.path(), names);
    put_bytes(folder / "poses.txt", kitti_rows(rows));
    return places(open_input(folder.path()));
  };
  using X = std::vector<double>;
  EXPECT_EQ(found({"cloud_7.pcd", "cloud_8.pcd"}, 20), (X{7, 8}));
  EXPECT_EQ(found({"cloud_19.pcd", "cloud_20.pcd"}, 20), (X{18, 19})) << "counted from 1";
  EXPECT_EQ(found({"cloud_1.pcd", "cloud_2.pcd"}, 2), (X{0, 1}));
  EXPECT_EQ(found({"cloud_70.pcd", "cloud_80.pcd"}, 2), (X{0, 1}));
}

TEST(ScanNames, TimesHaveTheUnitOfTheirDigits) {
  const auto time = [](const std::string& name) { return scan_file(name).time_s.value_or(-1); };
  for (const char* name :
       {"1600000030100000000.bin", "1600000030100000.bin", "1600000030100.bin",
        "1600000030_100000000.pcd", "1600000030_100000.pcd", "1600000030_100.pcd.gz",
        "1600000030.1.pcd", "cloud_1600000030_100000000.pcd", "frame000104-1600000030_100.ply",
        "n015-2018-07-24-11-22-45+0800__LIDAR_TOP__1600000030100000.pcd"}) {
    EXPECT_NEAR(time(name), 1600000030.1, 1e-6) << name;
  }
  EXPECT_NEAR(time("PC_315969904359876000.ply"), 315969904.359876, 1e-6);
  EXPECT_EQ(time("1600000030.bin"), 1600000030);
  for (const char* name : {"000100.bin", "0000000100.bin", "123456789.bin", "cloud_7.pcd",
                           "20201231235959.pcd", "1600000030_5.pcd", "2018-07-24-11-22-45.pcd"}) {
    EXPECT_EQ(time(name), -1) << name;
  }
  EXPECT_EQ(scan_file("000000000100.bin").frame, 100u);
  const TemporaryFolder folder;  // The longest one tells the digits of names without zeros.
  put_clouds(folder.path(), {"1600000030_900000.pcd", "1600000031_0.pcd", "1600000031_5000.pcd"});
  std::vector<std::string> notes;
  const std::vector<ScanFile> files = list_scans(folder.path(), notes);
  EXPECT_NEAR(*files[0].time_s, 1600000030.9, 1e-6);
  EXPECT_NEAR(*files[2].time_s, 1600000031.005, 1e-6);
  EXPECT_EQ(notes.size(), 1u);
}

TEST(ScanNames, NamesOfAnotherClockGoByOrder) {
  const TemporaryFolder folder;
  put_clouds(folder.path(), {"1600000030100000.bin", "1600000030200000.bin"});
  put_bytes(folder / "poses.txt", tum_rows({1600000030.1, 1600000030.3}));
  EXPECT_NEAR(places(open_input(folder.path()))[1], 1, 1e-5) << "as many poses, of other times";
  put_bytes(folder / "poses.txt", tum_rows({5, 5.1}));
  EXPECT_NEAR(places(open_input(folder.path()))[1], 1, 1e-9);
}

TEST(ScanFolder, TimesOfScansAreBroughtToSeconds) {
  const auto read = [](const std::string& times, const std::string& poses, double period_s) {
    const TemporaryFolder folder;
    put_clouds(folder.path(), {"0.bin", "1.bin", "2.bin", "3.bin"});
    put_bytes(folder / "poses.txt", poses);
    put_bytes(folder / "times.txt", times);
    InputOptions options;
    options.scan_period_s = period_s;
    const Input input = open_input(folder.path(), options);
    return std::vector<double>{input.scan_infos[3].time_s - input.scan_infos[0].time_s,
                               places(input)[3]};
  };
  const std::string rows = kitti_rows(4);
  for (const double period : {0.0, 0.1}) {
    EXPECT_NEAR(read("0\n100\n200\n300\n", rows, period)[0], 0.3, 1e-9);
    EXPECT_NEAR(read("7\n100007\n200007\n300007\n", rows, period)[0], 0.3, 1e-9);
    EXPECT_NEAR(read("5\n100000005\n200000005\n300000005\n", rows, period)[0], 0.3, 1e-9);
    EXPECT_EQ(read("0\n0.1\n0.2\n0.3\n", rows, period)[0], 0.3);
    EXPECT_EQ(read("0\n1\n2\n3\n", rows, period)[0], 3) << "one a second";
    EXPECT_EQ(read("0\n61\n97\n181\n", rows, period)[0], 181) << "stations";
  }
  EXPECT_NEAR(read("1600000000000000000\n1600000000100000000\n1600000000200000000\n"
                   "1600000000300000000\n",
                   rows, 0)[0],
              0.3, 1e-6);
  EXPECT_NEAR(read("0\n130\n200\n330\n", tum_rows({0, 0.5}), 0)[1], 3.3, 1e-9)
      << "within the times of the poses";
  EXPECT_NEAR(read("0\n100\n200\n300\n", tum_rows({0, 100, 200, 300, 400}), 0)[0], 0.3, 1e-9)
      << "poses in the same unit";
}

TEST(ScanFolder, ScansInGapsOfThePosesAreLeftOut) {
  const TemporaryFolder folder;
  std::vector<double> times;
  for (int k = 0; k <= 200; ++k) {
    if (k <= 40 || k >= 160) times.push_back(0.05 * k);
  }
  put_bytes(folder / "poses.txt", tum_rows(times));
  put_clouds(folder.path(), {"0.bin", "1.bin", "2.bin", "3.bin"});
  put_bytes(folder / "times.txt", "1\n4\n7\n9\n");
  Input input = open_input(folder.path());
  EXPECT_EQ(places(input), (std::vector<double>{10, 90}));
  EXPECT_EQ(input.skipped().at("scans in gaps of the poses"), 2u);
  put_bytes(folder / "times.txt", "4\n5\n6\n7\n");
  EXPECT_THROW(open_input(folder.path()), FormatError);
}

TEST(PoseGaps, AreLongMotionsAlone) {
  const auto poses = [](double gap_s, double way_m) {
    std::vector<StampedPose> out;
    for (int k = 0; k < 40; ++k) {
      const bool after = k >= 20;
      out.push_back({0.1 * k + (after ? gap_s : 0), {}});
      out.back().world_from_sensor.translation.x() = 0.1 * k + (after ? way_m : 0);
    }
    return out;
  };
  const auto gaps = [&](double gap_s, double way_m) {
    std::vector<StampedPose> path = poses(gap_s, way_m);
    return split_at_gaps(path, 0.1).size();
  };
  EXPECT_EQ(gaps(10, 20), 1u);
  EXPECT_EQ(gaps(10, 0.1), 0u) << "it stood";
  EXPECT_EQ(gaps(0.5, 5), 0u) << "short";
  std::vector<StampedPose> path = poses(10, 20);  // A scan of 0.1 s that begins at the last pose
  const std::vector<PoseGap> found = split_at_gaps(path, 0.1);
  EXPECT_NEAR(Trajectory(path).at(2.0)->translation.x(), 2, 1e-9) << "moves as before";
  EXPECT_NEAR(Trajectory(path).at(11.9)->translation.x(), 21.9, 1e-9);
  EXPECT_FALSE(found[0].has(1.95));
  EXPECT_TRUE(found[0].has(6));
}

TEST(ScanFolder, PackedAndEmptyScansCount) {
  const TemporaryFolder folder;
  put_clouds(folder.path(), {"000000.pcd", "000003.pcd"});
  const std::string bytes = sample_pcd();
  const gzFile out = gzopen((folder / "000001.pcd.gz").c_str(), "wb");
  gzwrite(out, bytes.data(), unsigned(bytes.size()));
  gzclose(out);
  put_bytes(folder / "000002.pcd", "");
  put_bytes(folder / "poses.txt", kitti_rows(4));
  Input input = open_input(folder.path());
  std::vector<size_t> sizes;
  for (size_t k = 0; k < input.scans->size(); ++k) sizes.push_back(input.scans->read(k).size());
  EXPECT_EQ(sizes, (std::vector<size_t>{5, 5, 0, 5}));
  EXPECT_EQ(input.skipped().size(), 1u);
}

}  // namespace
}  // namespace underbrush::io
