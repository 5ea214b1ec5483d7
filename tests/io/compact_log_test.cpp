// Tests of compact logs behind the reader and the writer of logs.
#include <gtest/gtest.h>

#include "random_log.hpp"
#include "temporary.hpp"
#include "underbrush/io/input.hpp"
#include "underbrush/io/log_file.hpp"

namespace underbrush::io {
namespace {

// A log of either format becomes one of the other and back without a changed bit.
TEST(CompactLog, HoldsWhatARayCloudHolds) {
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

TEST(CompactLog, IsKnownByItsContent) {
  const TemporaryFolder folder;
  write_log(folder / "a.UBLOG", random_log(7, 1000, 0), kProvenance);
  std::filesystem::rename(folder / "a.UBLOG", folder / "b.ply");
  EXPECT_EQ(LogReader(folder / "b.ply").size(), 1000u);
  const Input input = open_input(folder / "b.ply");
  EXPECT_EQ(input.format, "compact");
  EXPECT_TRUE(input.is_log);
  EXPECT_EQ(input.beams->size(), 1000u);
}

TEST(CompactLog, TakesItsLimitsFromTheData) {
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

}  // namespace
}  // namespace underbrush::io
