#include "underbrush/io/table.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

#include "formats.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/input.hpp"
#include "underbrush/io/log_file.hpp"

namespace underbrush::io {
namespace {

/// A reader with a valid file.
struct Reader {
  const char* name;
  const char* file;
  std::string good;
  bool binary;     ///< Whether every truncation can be detected.
  bool has_magic;  ///< Whether other kinds of file can be detected.
  bool has_ring;
};

std::vector<Reader> readers() {
  const std::string header = "x,y,z,intensity,ring,t\n";
  return {{"ply", "a.ply", sample_ply(), true, true, true},
          {"pcd_binary", "a.pcd", sample_pcd(), true, true, true},
          {"pcd_ascii", "a.pcd", sample_pcd_ascii(), false, true, true},
          {"pcd_packed", "a.pcd", sample_pcd_packed(), true, true, true},
          {"npy", "a.npy", sample_npy(), true, true, true},
          {"npz", "a.npz", sample_npz(), true, true, true},
          {"kitti", "a.bin", sample_bin(), true, false, false},
          {"csv", "a.csv", header + sample_text(','), false, true, true},
          {"csv_tab", "a.csv", "#X\tY\tZ\tscalar_Intensity\tring\tt\r\n" + sample_text('\t'), false,
           true, true}};
}

class EveryReader : public testing::TestWithParam<size_t> {
 protected:
  const Reader reader_ = readers()[GetParam()];
  const TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_ / reader_.file;

  PointScan scan(const std::string& bytes) {
    put_bytes(path_, bytes);
    std::map<std::string, size_t> skipped;
    return scan_from_table(path_.string(), read_table(path_), {}, skipped);
  }
  void refuses(const std::string& bytes, const char* what) {
    try {
      scan(bytes);
      ADD_FAILURE() << "accepted: " << what;
    } catch (const FormatError& e) {
      const std::string line = e.what();
      EXPECT_NE(line.find(reader_.file), std::string::npos) << line;
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    }
  }
};

TEST_P(EveryReader, ReadsTheSample) {
  const PointScan s = scan(reader_.good);
  ASSERT_EQ(s.size(), kSample.size());
  for (size_t i = 0; i < s.size(); ++i) {
    EXPECT_EQ(s.point[i], Vec3f(kSample[i].x, kSample[i].y, kSample[i].z));
    EXPECT_EQ(s.intensity[i], kSample[i].intensity);
    if (reader_.has_ring) {
      EXPECT_EQ(s.ring[i], kSample[i].ring);
    }
    if (reader_.has_ring && reader_.file != std::string("a.csv")) {
      EXPECT_NEAR(s.time_s[i], kSample[i].t_ns * 1e-9, 1e-12);
    }
  }
  EXPECT_TRUE(s.extra.empty());
}

TEST_P(EveryReader, TellsEveryTruncation) {
  if (!reader_.binary) return;  // a text file may end after any line
  for (size_t n = 0; n < reader_.good.size(); ++n) {
    if (reader_.name == std::string("kitti") && n > 0 && n % 16 == 0) continue;
    refuses(reader_.good.substr(0, n), "truncated");
  }
}

TEST_P(EveryReader, TextTruncatedInsideAHeaderOrRow) {
  if (reader_.binary) return;
  const size_t last_row = reader_.good.rfind('\n', reader_.good.size() - 2);
  for (size_t n = 0; n < reader_.good.find('\n'); ++n) refuses(reader_.good.substr(0, n), "header");
  refuses(reader_.good.substr(0, last_row + 5), "row");
  std::string word = reader_.good;
  word.replace(last_row + 1, 2, "zz");
  refuses(word, "not a number");
}

TEST_P(EveryReader, RefusesOtherKindsOfFile) {
  refuses("", "empty file");
  if (!reader_.has_magic) return;
  refuses(std::string(1000, '\0'), "zeros");
  refuses("\x89PNG\r\n\x1a\n and so on\n", "a picture");
  refuses(sample_bin(), "KITTI");
}

TEST_P(EveryReader, RefusesFoldersAndAbsentFiles) {
  EXPECT_THROW(read_table(folder_ / "absent" / reader_.file), FormatError);
  std::filesystem::create_directories(path_);
  EXPECT_THROW(read_table(path_), FormatError);
}

TEST_P(EveryReader, RefusesWithoutPermission) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
  put_bytes(path_, reader_.good);
  std::filesystem::permissions(path_, std::filesystem::perms::none);
  EXPECT_THROW(read_table(path_), FormatError);
}

// Whichever single byte is wrong, the reader gives a scan or an error of one line. The seed is 5.
TEST_P(EveryReader, SurvivesEveryWrongByte) {
  Stream random(5);
  for (size_t i = 0; i < reader_.good.size(); ++i) {
    std::string bytes = reader_.good;
    bytes[i] = char(random.bits());
    try {
      scan(bytes);
    } catch (const FormatError&) {
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, EveryReader, testing::Range<size_t>(0, 9),
                         [](const auto& p) { return std::string(readers()[p.param].name); });

PointScan from(Table table, const ScanContext& context, std::map<std::string, size_t>& skipped) {
  return scan_from_table("f", std::move(table), context, skipped);
}

Table table_with(const std::string& name, ExtraColumn column) {
  return {{{"x", std::vector<double>{1, 2}},
           {"y", std::vector<double>{0, 0}},
           {"z", std::vector<double>{0, 0}},
           {name, std::move(column)}},
          std::nullopt,
          {}};
}

TEST(ScanFromTable, UnderstandsTimes) {
  std::map<std::string, size_t> skipped;
  ScanContext context;
  context.info.time_s = 1000;
  const auto second = [&](const std::string& name, ExtraColumn column) {
    return from(table_with(name, std::move(column)), context, skipped).time_s.at(1);
  };
  for (const char* name : {"t", "time", "timestamp", "time_stamp", "stamp", "time_offset",
                           "timeOffset", "scalar_Time"}) {
    EXPECT_NEAR(second(name, std::vector<float>{0, 0.5f}), 1000.5, 1e-9) << name;
  }
  EXPECT_NEAR(second("t", std::vector<uint32_t>{0, 500000000}), 1000.5, 1e-9);
  EXPECT_NEAR(second("t", std::vector<int32_t>{-5, -500000000}), 999.5, 1e-9);
  EXPECT_NEAR(second("t", std::vector<double>{1.3e9, 1.3e9 + 1}), 1.3e9 + 1, 1e-6);
  EXPECT_NEAR(second("t", std::vector<double>{1.3e18, 1.3e18 + 1e9}), 1.3e9 + 1, 1e-6);
}

TEST(ScanFromTable, KeepsWhatItDoesNotKnow) {
  std::map<std::string, size_t> skipped;
  const PointScan s = from(table_with("scalar_tree", std::vector<int16_t>{-7, 8}), {}, skipped);
  EXPECT_EQ(std::get<std::vector<int16_t>>(s.extra.at("tree")), (std::vector<int16_t>{-7, 8}));
  const PointScan r = from(table_with("ring", std::vector<float>{0.5f, 1}), {}, skipped);
  EXPECT_TRUE(r.ring.empty());
  EXPECT_EQ(r.extra.count("ring"), 1u);
}

TEST(ScanFromTable, CountsWhatItCannotUse) {
  std::map<std::string, size_t> skipped;
  Table table = table_with("intensity", std::vector<float>{NAN, INFINITY});
  std::get<std::vector<double>>(table.columns[0].second)[1] = 1e300;
  const PointScan s = from(table, {}, skipped);
  EXPECT_EQ(s.intensity[0], 0);
  EXPECT_TRUE(std::isnan(s.point[1].x()));
  EXPECT_EQ(skipped.size(), 2u);
  EXPECT_THROW(from({}, {}, skipped), FormatError);
}

// Points in UTM are moved back to the sensor in double precision before they become float.
TEST(ScanFromTable, LargeWorldCoordinatesKeepMillimetres) {
  std::map<std::string, size_t> skipped;
  ScanContext context;
  context.points_in_world = true;
  context.info.world_from_sensor = {Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vec3::UnitZ())),
                                    Vec3(5e6, 5e6, 100)};
  Table table = table_with("k", std::vector<uint8_t>{0, 0});
  const Vec3 point(5e6 + 12.345, 5e6 - 6.789, 101.5);
  for (size_t c = 0; c < 3; ++c) {
    std::get<std::vector<double>>(table.columns[c].second)[0] = point[Eigen::Index(c)];
  }
  const PointScan s = from(table, context, skipped);
  EXPECT_LT((context.info.world_from_sensor * s.point[0].cast<double>() - point).norm(), 1e-5);
}

TEST(Pcd, RefusesAbsurdCountsAndReadsSideFields) {
  const TemporaryFolder folder;
  const auto path = folder / "a.pcd";
  for (const int points : {6, 2000000000}) {
    put_bytes(path, pcd_header("binary", points) + sample_rows());
    EXPECT_THROW(read_pcd(path), FormatError);
    put_bytes(path, pcd_header("ascii", points) + sample_text(' '));
    EXPECT_THROW(read_pcd(path), FormatError);
  }
  std::string s =
      "VERSION .7\nFIELDS x y z _ n stamp\nSIZE 4 4 4 1 2 8\nTYPE F F F U I U\nCOUNT 1 1 1 4 2 1\n"
      "WIDTH 1\nHEIGHT 1\nVIEWPOINT 1 2 3 0 0 0 1\nPOINTS 1\nDATA binary\n";
  for (float v : {1.f, 2.f, 3.f}) add(s, v);
  s += "pad.";
  add(s, int16_t(-1)), add(s, int16_t(2)), add(s, uint64_t(1) << 40);
  put_bytes(path, s);
  const Table table = read_pcd(path);
  ASSERT_EQ(table.columns.size(), 6u);
  EXPECT_EQ(table.columns[3].first, "n_0");
  EXPECT_EQ(std::get<std::vector<int16_t>>(table.columns[4].second)[0], 2);
  EXPECT_EQ(std::get<std::vector<double>>(table.columns[5].second)[0], double(uint64_t(1) << 40));
  EXPECT_EQ(table.viewpoint->translation, Vec3(1, 2, 3));
  s.replace(s.find("0 0 0 1\n"), 7, "0 0 0 2");
  put_bytes(path, s);
  EXPECT_THROW(read_pcd(path), FormatError);
  s.replace(s.find("0 0 0 2\n"), 7, "0 0 0 1");
  s.replace(s.find("TYPE F F F U I U"), 16, "TYPE F F F U F U");  // two bytes are no float
  put_bytes(path, s);
  EXPECT_THROW(read_pcd(path), FormatError);
}

// The program without the Python package names it.
TEST(Recordings, TheirReaderIsNamed) {
  const TemporaryFolder folder;
  for (const char* name : {"a.laz", "a.las", "a.bag", "a.mcap", "a.db3", "a.pcap", "A.E57"}) {
    write_atomically(folder / name, "x");
    const auto reason = [&](auto read) -> std::string {
      try {
        read(folder / name);
      } catch (const FormatError& e) {
        return e.what();
      }
      return "";
    };
    const std::string told = "pip install 'underbrush[formats]'";
    EXPECT_NE(reason([](const auto& path) { read_table(path); }).find(told), std::string::npos);
    EXPECT_NE(reason([](const auto& path) { BeamReader reader(path, 10); }).find(told),
              std::string::npos);
  }
}

}  // namespace
}  // namespace underbrush::io
