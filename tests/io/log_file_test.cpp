#include "underbrush/io/log_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>

#include "temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/io/input.hpp"

namespace underbrush::io {
namespace {

const char* const kProvenance = R"({"command":["time","intensity"],"when\time":"\"intensity\""})";

BeamLog random_log(uint64_t seed, size_t n, double far, bool colours = false) {
  Stream random(seed);
  BeamLog log;
  log.info.sensor = "lifetime-intensity";
  log.info.max_range_m = 120;
  log.info.min_range_m = 0.9;
  log.info.has_misses = true;
  log.info.deskewed = true;
  for (uint32_t s = 0; s < 3; ++s) {
    Eigen::Quaterniond q(random.normal(), 0, 0, 0);
    q.x() = random.normal(), q.y() = random.normal(), q.z() = random.normal();
    log.info.scans.push_back({10 + s, 1.3e9 + 0.1 * s, {q.normalized(), Vec3(far, s, -0.1)}});
  }
  log.extra["class"] = std::vector<uint16_t>{};
  log.extra["small"] = std::vector<int8_t>{};
  log.extra["intensity of time"] = std::vector<int16_t>{};
  log.extra["xray"] = std::vector<double>{};
  log.extra["ring"] = std::vector<float>{};
  if (colours) {
    for (const char* c : {"red", "green", "blue"}) log.extra[c] = std::vector<uint8_t>{};
  }
  log.resize(n);
  for (size_t i = 0; i < n; ++i) {
    Vec3 d;
    for (int c = 0; c < 3; ++c) log.origin[i][c] = far + random.normal(), d[c] = random.normal();
    log.direction[i] = d.normalized().cast<float>();
    log.range_m[i] = random.uniform() < 0.2 ? kMiss : float(std::exp2(random.uniform(-8, 10)));
    // The grid of ranges changes at powers of two.
    if (i % 16 == 0) log.range_m[i] = std::nextafter(float(1 << (i / 16 % 9)), i % 32 ? 0.f : 1e9f);
    log.intensity[i] = log.is_hit(i) ? float(random.uniform()) : 0.f;
    log.time_s[i] = 1.3e9 + random.uniform();
    log.ring[i] = uint16_t(i % 64);
    log.scan[i] = uint32_t(10 + i % 3);
    log.packet[i] = uint32_t(i / 7);
    log.flags[i] = uint8_t(i % 2);
    for (auto& [name, column] : log.extra) {
      std::visit([&](auto& c) { c[i] = std::decay_t<decltype(c[0])>(random.below(120)); }, column);
    }
  }
  return log;
}

void expect_same(const BeamLog& a, const BeamLog& b) {
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_EQ(a.range_m, b.range_m);
  EXPECT_EQ(a.intensity, b.intensity);
  EXPECT_EQ(a.time_s, b.time_s);
  EXPECT_EQ(a.ring, b.ring);
  EXPECT_EQ(a.scan, b.scan);
  EXPECT_EQ(a.packet, b.packet);
  EXPECT_EQ(a.flags, b.flags);
  EXPECT_EQ(a.extra, b.extra);
  EXPECT_EQ(a.info.sensor, b.info.sensor);
  EXPECT_EQ(a.info.min_range_m, b.info.min_range_m);
  EXPECT_EQ(a.info.max_range_m, b.info.max_range_m);
  EXPECT_EQ(a.info.has_misses, b.info.has_misses);
  EXPECT_EQ(a.info.deskewed, b.info.deskewed);
  ASSERT_EQ(a.info.scans.size(), b.info.scans.size());
  for (size_t s = 0; s < a.info.scans.size(); ++s) {
    EXPECT_EQ(a.info.scans[s].scan, b.info.scans[s].scan);
    EXPECT_EQ(a.info.scans[s].time_s, b.info.scans[s].time_s);
    EXPECT_EQ(a.info.scans[s].world_from_sensor.translation,
              b.info.scans[s].world_from_sensor.translation);
    EXPECT_EQ(a.info.scans[s].world_from_sensor.rotation.coeffs(),
              b.info.scans[s].world_from_sensor.rotation.coeffs());
  }
}

struct Case {
  double far;
  bool double_coordinates, colours;
};
class RoundTrip : public testing::TestWithParam<Case> {};

// A log that was written and read once comes unchanged through every further round, to the byte.
TEST_P(RoundTrip, WriteReadWriteIsTheSameToTheByte) {
  const TemporaryFolder folder;
  const LogWriterOptions options{GetParam().double_coordinates};
  const BeamLog log = random_log(7, 20000, GetParam().far, GetParam().colours);
  write_log(folder / "a.ply", log, kProvenance, options);
  const BeamLog once = read_log(folder / "a.ply");
  write_log(folder / "b.ply", once, kProvenance, options);
  expect_same(once, read_log(folder / "b.ply"));
  EXPECT_TRUE(bytes_of(folder / "a.ply") == bytes_of(folder / "b.ply"));
}

TEST_P(RoundTrip, KeepsEveryColumn) {
  const TemporaryFolder folder;
  const BeamLog log = random_log(8, 20000, GetParam().far, GetParam().colours);
  write_log(folder / "a.ply", log, kProvenance, {GetParam().double_coordinates});
  BeamLog back = read_log(folder / "a.ply");
  const double origin_error = GetParam().double_coordinates ? 4e-8 : 2e-7 * GetParam().far + 1e-4;
  for (size_t i = 0; i < log.size(); ++i) {
    ASSERT_EQ(log.is_hit(i), back.is_hit(i));
    ASSERT_LE((log.origin[i] - back.origin[i]).cwiseAbs().maxCoeff(), origin_error);
    ASSERT_LE((log.direction[i] - back.direction[i]).norm(), log.range_m[i] < 0.1f ? 3e-5 : 5e-7);
    ASSERT_NEAR(back.direction[i].norm(), 1, 4e-7);
    if (log.is_hit(i)) {
      ASSERT_NEAR(back.range_m[i], log.range_m[i], 4.5e-7 * log.range_m[i] + 6e-8);
    }
    if (log.range_m[i] <= 120 && GetParam().double_coordinates) {
      ASSERT_LE((log.end_point(i) - back.end_point(i)).norm(), 1e-4);
    }
  }
  back.origin = log.origin, back.direction = log.direction, back.range_m = log.range_m;
  expect_same(log, back);
}

INSTANTIATE_TEST_SUITE_P(Places, RoundTrip,
                         testing::Values(Case{0, true, false}, Case{100, true, true},
                                         Case{5e6, true, false}, Case{300, false, false}));

TEST(LogFile, ChunksAndThreadsDoNotChangeTheBytes) {
  const TemporaryFolder folder;
  const BeamLog log = random_log(9, 30000, 50);
  write_log(folder / "a.ply", log, kProvenance);
  set_threads(1);
  LogReader reader(folder / "a.ply", 777);
  EXPECT_EQ(reader.size(), log.size());
  LogWriter writer(folder / "b.ply", reader.info(), reader.provenance());
  BeamLog chunk;
  while (reader.next(chunk)) writer.write(chunk);
  EXPECT_TRUE(chunk.empty());
  EXPECT_FALSE(std::filesystem::exists(folder / "b.ply"));
  writer.close();
  set_threads(0);
  EXPECT_TRUE(bytes_of(folder / "a.ply") == bytes_of(folder / "b.ply"));
  reader.rewind();
  ASSERT_TRUE(reader.next(chunk));
  EXPECT_EQ(chunk.size(), 777u);
}

// CSIRO's reader takes any header line with these words for the property.
TEST(LogFile, HeaderKeepsClearOfTheTraps) {
  const TemporaryFolder folder;
  write_log(folder / "a.ply", random_log(1, 10, 0), kProvenance);
  std::istringstream in(bytes_of(folder / "a.ply"));
  int time = 0, x = 0, nx = 0, red = 0;
  for (std::string line; std::getline(in, line) && line != "end_header";) {
    EXPECT_EQ(line.find("intensity"), std::string::npos) << line;
    EXPECT_LE(line.size(), 255u);
    time += line.find("time") != std::string::npos;
    x += line.find("property float x") == 0 || line.find("property double x") == 0;
    nx += line.find("property float nx") == 0 || line.find("property double nx") == 0;
    red += line.find("property uchar red") == 0;
  }
  EXPECT_EQ(time, 1);
  EXPECT_EQ(x, 1);
  EXPECT_EQ(nx, 1);
  EXPECT_EQ(red, 1);
  EXPECT_EQ(nlohmann::json::parse(LogReader(folder / "a.ply").provenance()),
            nlohmann::json::parse(kProvenance));
}

// Makes a file in the style of CSIRO's own: rows of 36 bytes and a zero-padded count.
std::string foreign_cloud(bool doubles) {
  const std::string real = doubles ? "double" : "float";
  std::string s =
      "ply\nformat binary_little_endian 1.0\ncomment generated by raycloudtools library\n"
      "element vertex 0000000000000000004\n";
  for (const char* axis : {"x", "y", "z"}) s += "property " + real + " " + axis + "\n";
  s += "property double time\nproperty float nx\nproperty float ny\nproperty float nz\n"
       "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
       "end_header\n";
  const auto row = [&](std::array<double, 3> end, double t, std::array<float, 3> n,
                       std::array<uint8_t, 4> rgba) {
    for (double v : end) doubles ? add(s, v) : add(s, float(v));
    add(s, t);
    for (float v : n) add(s, v);
    for (uint8_t v : rgba) add(s, v);
  };
  row({10, 0, 1}, 5.0, {-10, 0, 0}, {1, 2, 3, 200});
  row({0, 30, 1}, 5.0, {0, -30, 0}, {4, 5, 6, 0});
  row({1, 1, 1}, 5.1, {0, 0, 0}, {7, 8, 9, 10});
  row({NAN, 1, 1}, 5.1, {1, 0, 0}, {7, 8, 9, 10});
  return s;
}

TEST(LogFile, RowsAreThoseOfTheWholeLog) {
  TemporaryFolder folder;
  write_log(folder / "log.ply", random_log(5, 10000, 0), kProvenance);
  const BeamLog whole = read_log(folder / "log.ply");
  LogReader reader(folder / "log.ply", 3000);
  BeamLog chunk;
  reader.next(chunk);
  for (const auto& [first, n] : {std::pair<size_t, size_t>{0, 1}, {4095, 3}, {9990, 10}, {7, 0}}) {
    const BeamLog rows = reader.rows(first, n);
    ASSERT_EQ(rows.size(), n);
    for (size_t i = 0; i < n; ++i) {
      EXPECT_EQ(rows.end_point(i), whole.end_point(first + i));
      EXPECT_EQ(rows.packet[i], whole.packet[first + i]);
      EXPECT_EQ(std::get<std::vector<double>>(rows.extra.at("xray"))[i],
                std::get<std::vector<double>>(whole.extra.at("xray"))[first + i]);
    }
  }
  EXPECT_THROW(reader.rows(9990, 11), std::invalid_argument);
  EXPECT_THROW(reader.rows(SIZE_MAX, 2), std::invalid_argument);
  ASSERT_TRUE(reader.next(chunk));  // goes on where it was
  EXPECT_EQ(chunk.end_point(0), whole.end_point(3000));
}

TEST(LogFile, ReadsForeignRayClouds) {
  for (const bool doubles : {false, true}) {
    const TemporaryFolder folder;
    put_bytes(folder / "f.ply", foreign_cloud(doubles));
    LogReader reader(folder / "f.ply");
    EXPECT_EQ(reader.info().max_range_m, 30);
    EXPECT_TRUE(reader.info().has_misses);
    BeamLog log;
    ASSERT_TRUE(reader.next(log));
    ASSERT_EQ(log.size(), 2u);
    EXPECT_EQ(reader.skipped().at("not finite"), 1u);
    EXPECT_EQ(reader.skipped().at("zero-length ray"), 1u);
    EXPECT_EQ(log.origin[0], Vec3(0, 0, 1));
    EXPECT_EQ(log.direction[0], Vec3f(1, 0, 0));
    EXPECT_EQ(log.range_m[0], 10);
    EXPECT_EQ(log.intensity[0], 200);
    EXPECT_FALSE(log.is_hit(1));
    EXPECT_EQ(log.direction[1], Vec3f(0, 1, 0));
    EXPECT_EQ(log.time_s[1], 5.0);  // repeated times are kept
    EXPECT_EQ(std::get<std::vector<uint8_t>>(log.extra.at("green")), (std::vector<uint8_t>{2, 5}));
    EXPECT_FALSE(reader.next(log));
  }
}

TEST(LogFile, OwnLayoutToTheByte) {
  const TemporaryFolder folder;
  BeamLog log;
  log.info.sensor = "s";
  log.info.max_range_m = 50;
  log.extra["class"] = std::vector<uint16_t>{};
  log.resize(2);
  log.origin = {Vec3(1, 2, 3), Vec3(1, 2, 3)};
  log.direction = {Vec3f(1, 0, 0), Vec3f(0, 0, 1)};
  log.range_m = {4, kMiss};
  log.intensity = {0.5f, 0};
  log.time_s = {7, 8};
  log.ring = {3, 4};
  log.scan = {5, 5};
  log.packet = {6, 7};
  log.flags = {0, 1};
  log.extra["class"] = std::vector<uint16_t>{70, 0};
  log.info.scans = {{5, 7.25, {}}};
  write_log(folder / "a.ply", log, R"({"a":"time"})");
  std::string s =
      "ply\nformat binary_little_endian 1.0\n"
      "comment underbrush log {\"sensor\":\"s\",\"min_range_m\":0.0,\"max_range_m\":50.0,"
      "\"has_misses\":true ,\"deskewed\":false,\"colours\":false}\n"
      "comment underbrush scan 5 7.25 0 0 0 0 0 0 1\n"
      "comment underbrush provenance {\"a\":\"t\\u0069me\"}\n"
      "element vertex 00000000000000000002\n"
      "property double x\nproperty double y\nproperty double z\nproperty double time\n"
      "property float nx\nproperty float ny\nproperty float nz\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
      "property ushort ring\nproperty uint scan\nproperty uint packet\nproperty uchar flags\n"
      "property float remission\nproperty ushort class\nend_header\n";
  for (int i = 0; i < 2; ++i) {
    for (double v : i == 0 ? std::array{5., 2., 3., 7.} : std::array{1., 2., 53., 8.}) add(s, v);
    for (float v : i == 0 ? std::array{-4.f, 0.f, 0.f} : std::array{0.f, 0.f, -50.f}) add(s, v);
    for (int c = 0; c < 4; ++c) add(s, uint8_t(i == 0 ? 128 : 0));
    add(s, uint16_t(3 + i)), add(s, uint32_t(5)), add(s, uint32_t(6 + i)), add(s, uint8_t(i));
    add(s, i == 0 ? 0.5f : 0.f);
    add(s, uint16_t(i == 0 ? 70 : 0));
  }
  const std::string written = bytes_of(folder / "a.ply");
  EXPECT_EQ(written.substr(0, s.find("end_header")), s.substr(0, s.find("end_header")));
  EXPECT_TRUE(written == s);
}

TEST(LogFile, WithoutAColumnOfClassesHasNoLabelSet) {
  const TemporaryFolder folder;
  BeamLog log = random_log(1, 100, 0);
  log.info.classes = "underbrush";
  write_log(folder / "a.ply", log, kProvenance);
  EXPECT_EQ(LogReader(folder / "a.ply").info().classes, "underbrush");
  log.extra.erase("class");
  write_log(folder / "b.ply", log, kProvenance);
  EXPECT_EQ(LogReader(folder / "b.ply").info().classes, "");
}

TEST(LogFile, RefusesDamage) {
  const TemporaryFolder folder;
  write_log(folder / "a.ply", random_log(1, 100, 0), kProvenance);
  const std::string good = bytes_of(folder / "a.ply");
  const auto refuses = [&](const std::string& bytes, const std::string& reason) {
    put_bytes(folder / "bad.ply", bytes);
    try {
      read_log(folder / "bad.ply");
      ADD_FAILURE() << "accepted: " << reason;
    } catch (const FormatError& e) {
      EXPECT_NE(std::string(e.what()).find(reason), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("bad.ply"), std::string::npos);
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    }
  };
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string bytes = good;
    bytes.replace(bytes.find(from), from.size(), to);
    return bytes;
  };
  refuses(good.substr(0, good.size() - 1), "truncated");
  refuses(good.substr(0, 300), "truncated");
  refuses(good + "x", "bytes after the last row");
  refuses("", "too short");
  refuses("PK\3\4 not a ply at all", "is not a PLY file");
  refuses(with("00000000000000000100", "99999999999999999999"), "bad count");
  refuses(with("00000000000000000100", "09999999999999999999"), "truncated");
  refuses(with("00000000000000000100", "00000000000000000000"), "no beams");
  refuses(with("binary_little_endian", "ascii"), "little");
  refuses(with("property float nx", "property float qx"), "nx");
  refuses(with("\"deskewed\"", "\"deskewe\""), "damaged");
  refuses(with("scan 10 1.3e+09", "scan 10 nan"), "scan");
  EXPECT_THROW(read_log(folder.path()), FormatError);
  EXPECT_THROW(read_log(folder / "absent.ply"), FormatError);
}

TEST(LogFile, WriterRefusesWhatCannotBeRead) {
  const TemporaryFolder folder;
  const auto refuses = [&](auto change) {
    BeamLog log = random_log(1, 100, 0);
    change(log);
    EXPECT_THROW(write_log(folder / "a.ply", log, ""), std::invalid_argument);
    EXPECT_EQ(folder.entries(), 0u);
  };
  refuses([](BeamLog& log) { log.range_m[50] = NAN; });
  refuses([](BeamLog& log) { log.range_m[50] = 0; });
  refuses([](BeamLog& log) { log.origin[50].x() = INFINITY; });
  refuses([](BeamLog& log) { log.direction[50] *= 1.1f; });
  refuses([](BeamLog& log) { log.ring.pop_back(); });
  refuses([](BeamLog& log) { log.resize(0); });
  refuses([](BeamLog& log) { log.info.max_range_m = INFINITY; });
  refuses([](BeamLog& log) { log.info.scans[0].world_from_sensor.rotation.w() = 9; });
}

// A log of either format becomes one of the other and back without a changed bit.
TEST(LogFile, CompactLogsHoldWhatARayCloudHolds) {
  const TemporaryFolder folder;
  BeamLog log = random_log(7, 100'000, 5e6, true);
  log.info.classes = "semantickitti";
  log.info.element_classes = {"a tree", "intensity"};
  log.info.sensor_file = "name: mine\n";
  write_log(folder / "a.ply", log, kProvenance);
  const BeamLog once = read_log(folder / "a.ply");
  const LogReader cloud(folder / "a.ply");
  write_log(folder / "b.ublog", once, cloud.provenance());
  const LogReader compact(folder / "b.ublog");
  EXPECT_EQ(compact.provenance(), cloud.provenance());
  EXPECT_EQ(compact.info().classes, log.info.classes);
  EXPECT_EQ(compact.info().element_classes, log.info.element_classes);
  EXPECT_EQ(compact.info().sensor_file, log.info.sensor_file);
  const BeamLog back = read_log(folder / "b.ublog");
  expect_same(once, back);
  write_log(folder / "c.ply", back, compact.provenance());
  EXPECT_TRUE(bytes_of(folder / "a.ply") == bytes_of(folder / "c.ply"));
  EXPECT_LT(std::filesystem::file_size(folder / "b.ublog"),
            std::filesystem::file_size(folder / "a.ply"));
  // Unlike a ray cloud, it keeps what was written first, too.
  write_log(folder / "d.ublog", log, kProvenance);
  expect_same(log, read_log(folder / "d.ublog"));
}

TEST(LogFile, CompactLogsAreKnownByTheirContent) {
  const TemporaryFolder folder;
  write_log(folder / "a.UBLOG", random_log(7, 1000, 0), kProvenance);
  std::filesystem::rename(folder / "a.UBLOG", folder / "b.ply");
  EXPECT_EQ(LogReader(folder / "b.ply").size(), 1000u);
  const Input input = open_input(folder / "b.ply");
  EXPECT_EQ(input.format, "compact");
  EXPECT_TRUE(input.is_log);
  EXPECT_EQ(input.beams->size(), 1000u);
}

TEST(LogFile, CompactLogsTakeTheirLimitsFromTheData) {
  const TemporaryFolder folder;
  BeamLog log = random_log(7, 1000, 0);
  log.info.has_misses = false;
  log.range_m[7] = 812.5f;
  LogWriterOptions options;
  options.limits_from_data = true;
  for (const char* name : {"a.ply", "a.ublog"}) {
    write_log(folder / name, log, "", options);
    const LogReader reader(folder / name);
    EXPECT_TRUE(reader.info().has_misses);
    EXPECT_GE(reader.info().max_range_m, 812.5);
  }
}

// A window's rows are those of the whole log that lie in it, wherever the chunks begin.
TEST(LogFile, RowsInAWindowAreThoseOfTheWholeLog) {
  const TemporaryFolder folder;
  BeamLog log = random_log(7, 200'000, 0);
  for (size_t i = 0; i < log.size(); ++i) {
    log.time_s[i] = 50 + 1e-4 * double(i);
    log.origin[i].x() += 1e-3 * double(i);
  }
  Stream random(3);
  for (const char* name : {"a.ply", "a.ublog"}) {
    write_log(folder / name, log, "");
    const BeamLog whole = read_log(folder / name);
    const LogReader reader(folder / name, 50'000);
    for (int k = 0; k < 12; ++k) {
      LogWindow window;
      if (k % 3 != 0) window.first_s = random.uniform(49, 72);
      if (k % 3 != 0) window.last_s = window.first_s + random.uniform(0, 8);
      if (k % 2 != 0) {
        window.least = Vec3(random.uniform(-20, 200), -5, -5);
        window.most = window.least + Vec3(random.uniform(0, 40), 9, 9);
      }
      BeamLog expected = whole.like();
      for (size_t i = 0; i < whole.size(); ++i) {
        if (window.has(whole, i)) expected.append(whole, i);
      }
      expect_same(expected, reader.within(window));
    }
  }
}

TEST(LogFile, FullDiskLeavesNothing) {
  const TemporaryFolder folder;
  const BeamLog log = random_log(1, 20000, 0);
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const rlimit small{100000, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  std::vector<std::string> messages;
  for (const char* name : {"a.ply", "a.ublog"}) {
    try {
      write_log(folder / name, log, "");
    } catch (const IoError& e) {
      messages.emplace_back(e.what());
    }
  }
  setrlimit(RLIMIT_FSIZE, &old);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_NE(messages[0].find("a.ply: cannot write"), std::string::npos) << messages[0];
  EXPECT_NE(messages[1].find("a.ublog: cannot write"), std::string::npos) << messages[1];
  EXPECT_EQ(folder.entries(), 0u);
  EXPECT_THROW(write_log(folder / "no/such/folder/a.ply", log, ""), IoError);
}

}  // namespace
}  // namespace underbrush::io
