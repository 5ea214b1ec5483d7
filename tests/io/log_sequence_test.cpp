#include "underbrush/io/log_sequence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "io/random_log.hpp"
#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::io {
namespace {

/// All beams that are left of a source.
BeamLog rest_of(BeamSource& source) {
  BeamLog all, chunk;
  while (source.next(chunk)) {
    if (all.empty()) all = chunk.like();
    all.append(chunk, 0, chunk.size());
  }
  return all;
}

BeamLog all_of(BeamSource& source) {
  source.rewind();
  return rest_of(source);
}

/// Three logs in both formats, and the same beams as one log.
struct Logs {
  TemporaryFolder folder;
  std::vector<std::filesystem::path> files{folder / "a.ublog", folder / "b.ply",
                                           folder / "c.ublog"};
  BeamLog whole;
  Logs() {
    for (size_t k = 0; k < files.size(); ++k) {
      BeamLog log = random_log(k + 1, 900 + 50 * k, 10);
      write_log(files[k], log, "");
      log = read_log(files[k]);
      const auto before = uint32_t(whole.size());
      for (size_t i = 0; i < log.size(); ++i) log.scan[i] += before, log.packet[i] += before;
      for (ScanInfo& scan : log.info.scans) scan.scan += before;
      if (k == 0) {
        whole = log.like();
      } else {
        whole.info.scans.insert(whole.info.scans.end(), log.info.scans.begin(),
                                log.info.scans.end());
      }
      whole.append(log, 0, log.size());
    }
  }
};

TEST(LogSequence, HasTheBeamsOfAllLogs) {
  const Logs logs;
  LogSequence sequence(logs.files);
  EXPECT_EQ(sequence.size(), logs.whole.size());
  for (int time = 0; time < 2; ++time) {
    SCOPED_TRACE(time);
    const BeamLog all = all_of(sequence);
    expect_same(all, logs.whole);
    EXPECT_EQ(all.scan, logs.whole.scan);
    EXPECT_EQ(all.packet, logs.whole.packet);
  }
  ASSERT_EQ(sequence.info().scans.size(), 9u);
  EXPECT_EQ(sequence.info().scans[0].scan, 10u);
  EXPECT_EQ(sequence.info().scans[4].scan, 911u);
  EXPECT_EQ(sequence.info().scans[8].scan, 1862u);
}

TEST(LogSequence, OfOneLogIsThatLog) {
  const Logs logs;
  for (const auto& file : logs.files) {
    LogSequence sequence({file});
    LogReader reader(file);
    expect_same(all_of(sequence), rest_of(reader));
    EXPECT_EQ(sequence.info().scans.size(), reader.info().scans.size());
  }
}

TEST(LogSequence, PartsAreThoseOfTheWholeAndOpenNoOtherFile) {
  const Logs logs;
  LogSequence sequence(logs.files);
  using Part = std::pair<size_t, size_t>;
  for (const auto& [first, end] :
       {Part{0, 1}, Part{0, 900}, Part{899, 901}, Part{850, 1900}, Part{1850, 5000}}) {
    SCOPED_TRACE(first);
    sequence.keep_rows(first, end);
    BeamLog expected = logs.whole.like();
    expected.append(logs.whole, first, std::min(end, logs.whole.size()));
    const BeamLog part = rest_of(sequence);
    expect_same(part, expected);
    EXPECT_EQ(part.packet, expected.packet);
  }
  sequence.keep_rows(7, 7);
  EXPECT_TRUE(all_of(sequence).empty());
  std::filesystem::remove(logs.files[0]);
  std::filesystem::remove(logs.files[2]);
  sequence.keep_rows(900, 1850);
  EXPECT_EQ(all_of(sequence).size(), 950u);
  sequence.keep_rows(899, 1850);
  EXPECT_THROW(all_of(sequence), std::runtime_error);
}

TEST(LogSequence, RefusesLogsThatDoNotFit) {
  const Logs logs;
  const std::filesystem::path other = logs.folder / "other.ublog";
  const auto refusal = [&](std::vector<std::filesystem::path> files) -> std::string {
    try {
      LogSequence sequence(std::move(files));
    } catch (const FormatError& e) {
      return e.what();
    }
    return "";
  };
  const auto with = [&](const std::function<void(LogInfo&)>& change) {
    BeamLog log = random_log(9, 100, 10);
    change(log.info);
    write_log(other, log, "");
    return refusal({logs.files[0], other});
  };
  EXPECT_EQ(with([](LogInfo&) {}), "");
  EXPECT_NE(with([](LogInfo& i) { i.sensor = "ouster-os1-64"; }).find("sensor"), std::string::npos);
  EXPECT_NE(with([](LogInfo& i) { i.max_range_m = 90; }).find("90 m"), std::string::npos);
  EXPECT_NE(refusal({logs.files[0], logs.files[1], logs.folder / "." / "a.ublog"}).find("twice"),
            std::string::npos);
  BeamLog hits = random_log(9, 100, 10);
  hits.info.has_misses = false;
  for (float& range : hits.range_m) range = std::min(range, 100.f);
  write_log(other, hits, "");
  EXPECT_FALSE(LogSequence({logs.files[0], other}).info().has_misses);
  EXPECT_THROW(LogSequence({}), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::io
