#include "underbrush/core/read_ahead.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

namespace underbrush {
namespace {

BeamLog log_of(size_t beams) {
  BeamLog log;
  log.resize(beams);
  for (size_t i = 0; i < beams; ++i) {
    log.time_s[i] = double(i);
    log.origin[i] = Vec3::Zero();
    log.direction[i] = Vec3f::UnitX();
  }
  log.info.sensor = "one";
  return log;
}

/// A source that fails at a chunk, and counts how many it made.
class Failing : public MemorySource {
 public:
  Failing(const BeamLog& log, size_t chunk, size_t fails_at)
      : MemorySource(log, chunk), fails_at_(fails_at) {}
  void rewind() override {
    MemorySource::rewind();
    made = 0;
  }
  bool next(BeamLog& chunk) override {
    if (made == fails_at_) throw std::runtime_error("broken");
    ++made;
    return MemorySource::next(chunk);
  }
  std::atomic<size_t> made = 0;

 private:
  size_t fails_at_;
};

TEST(ReadAhead, GivesTheChunksOfItsSourceInOrder) {
  for (const int threads : {1, 0}) {
    set_threads(threads);
    for (const size_t beams : {size_t(0), size_t(1), size_t(10), size_t(1000)}) {
      const BeamLog log = log_of(beams);
      MemorySource source(log, 10), plain(log, 10);
      ReadAhead ahead(source);
      EXPECT_EQ(ahead.size(), beams);
      EXPECT_EQ(ahead.info().sensor, "one");
      for (int round = 0; round < 3; ++round) {
        ahead.rewind();
        plain.rewind();
        BeamLog chunk, expected;
        size_t chunks = 0;
        while (plain.next(expected) && (round != 1 || chunks < 3)) {  // the second is left early
          ASSERT_TRUE(ahead.next(chunk));
          ASSERT_EQ(chunk.time_s, expected.time_s);
          ++chunks;
        }
        if (round == 1) continue;
        for (int again = 0; again < 2; ++again) {
          EXPECT_FALSE(ahead.next(chunk));
          EXPECT_TRUE(chunk.empty());
        }
      }
    }
  }
  set_threads(0);
}

TEST(ReadAhead, PassesAnExceptionOnWhereItsChunkIsDue) {
  const BeamLog log = log_of(100);
  Failing source(log, 10, 4);
  ReadAhead ahead(source);
  BeamLog chunk;
  for (int k = 0; k < 4; ++k) {
    ASSERT_TRUE(ahead.next(chunk));
    EXPECT_EQ(chunk.time_s[0], 10 * k);
  }
  EXPECT_THROW(ahead.next(chunk), std::runtime_error);
  ahead.rewind();
  ASSERT_TRUE(ahead.next(chunk));
  EXPECT_EQ(chunk.time_s[0], 0);
}

TEST(ReadAhead, MakesOneChunkAheadWhileItsCallerWorks) {
#ifndef __SANITIZE_THREAD__  // whose loops have no thread in the background
  if (threads() < 2) GTEST_SKIP() << "one processor";
  using Clock = std::chrono::steady_clock;
  const BeamLog log = log_of(1000);
  Failing source(log, 10, 1000);
  {
    ReadAhead ahead(source);
    BeamLog chunk;
    ASSERT_TRUE(ahead.next(chunk));
    const auto end = Clock::now() + std::chrono::seconds(20);
    while (source.made < 2 && Clock::now() < end) std::this_thread::yield();
    EXPECT_EQ(source.made, 2u);
  }
  EXPECT_EQ(source.made, 2u);
#endif
}

}  // namespace
}  // namespace underbrush
