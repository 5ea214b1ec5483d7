#include "underbrush/fit/kept_beams.hpp"

#include <gtest/gtest.h>

namespace underbrush::fit {
namespace {

/// Counts the chunks that are read from a log in memory.
class Counted : public BeamSource {
 public:
  explicit Counted(const BeamLog& log) : source_(log, 300) {}
  const LogInfo& info() const override { return source_.info(); }
  size_t size() const override { return source_.size(); }
  void rewind() override { source_.rewind(); }
  bool next(BeamLog& chunk) override {
    const bool more = source_.next(chunk);
    chunks += more;
    return more;
  }
  size_t chunks = 0;

 private:
  MemorySource source_;
};

BeamLog numbered(size_t n) {
  BeamLog log;
  log.info.sensor = "some";
  log.resize(n);
  log.extra["class"] = std::vector<uint16_t>(n);
  for (size_t i = 0; i < n; ++i) log.packet[i] = uint32_t(i);
  return log;
}

void expect_all(BeamSource& source, size_t n) {
  source.rewind();
  size_t next = 0;
  for (BeamLog chunk; source.next(chunk);) {
    ASSERT_EQ(chunk.extra.size(), 1u);
    for (size_t i = 0; i < chunk.size(); ++i) ASSERT_EQ(chunk.packet[i], next++);
  }
  EXPECT_EQ(next, n);
}

TEST(KeptBeams, AShortLogIsReadOnceThoughAPassStopsOnItsWay) {
  const BeamLog log = numbered(1000);
  Counted source(log);
  KeptBeams kept(source, 1000 * 100);
  EXPECT_EQ(kept.size(), 1000u);
  EXPECT_EQ(kept.info().sensor, "some");
  BeamLog chunk;
  EXPECT_TRUE(kept.next(chunk));
  for (int pass = 0; pass < 3; ++pass) expect_all(kept, 1000);
  EXPECT_EQ(source.chunks, 4u);
}

TEST(KeptBeams, ALongLogIsReadAgainInEachPass) {
  const BeamLog log = numbered(1000);
  Counted source(log);
  KeptBeams kept(source, 1000 * 50);  // a beam has more bytes
  for (int pass = 0; pass < 3; ++pass) expect_all(kept, 1000);
  EXPECT_EQ(source.chunks, 12u);
}

}  // namespace
}  // namespace underbrush::fit
