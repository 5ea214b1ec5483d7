#include "underbrush/core/still_beams.hpp"

#include <gtest/gtest.h>

#include "underbrush/core/rng.hpp"

namespace underbrush {
namespace {

BeamLog numbered(size_t n) {
  BeamLog log;
  log.resize(n);
  for (size_t i = 0; i < n; ++i) log.packet[i] = uint32_t(i);
  return log;
}

std::vector<uint32_t> packets_of(BeamSource& source) {
  std::vector<uint32_t> out;
  source.rewind();
  for (BeamLog chunk; source.next(chunk);) {
    EXPECT_FALSE(chunk.empty());
    out.insert(out.end(), chunk.packet.begin(), chunk.packet.end());
  }
  return out;
}

TEST(StillBeams, LeavesOutMarkedBeamsAndNothingElse) {
  Stream random(3);
  BeamLog log = numbered(1000);
  std::vector<uint32_t> expected;
  for (uint32_t i = 0; i < 1000; ++i) {
    const bool is_marked = random.uniform() < 0.3 || (i >= 200 && i < 450);
    log.flags[i] = uint8_t(kInferred | (is_marked ? kMover : 0));
    if (!is_marked) expected.push_back(i);
  }
  MemorySource source(log, 100);  // Two chunks of it have marked beams alone.
  StillBeams still(source);
  for (int reading = 0; reading < 2; ++reading) {
    EXPECT_EQ(packets_of(still), expected);
    EXPECT_EQ(still.left_out(), 1000 - expected.size());
  }
}

TEST(StillBeams, ABeamOfSeveralEchoesGoesAsAWhole) {
  BeamLog log = numbered(7);
  log.extra[kEchoColumn] = std::vector<uint8_t>{1, 2, 3, 0, 1, 2, 1};
  log.flags = {0, kMover, 0, 0, 0, 0, kMover};
  MemorySource source(log);
  StillBeams still(source);
  EXPECT_EQ(packets_of(still), (std::vector<uint32_t>{3, 4, 5}));
}

TEST(StillBeams, ALogWithoutMarksPassesAsItIs) {
  BeamLog log = numbered(10);
  log.flags[3] = kInferred;
  MemorySource source(log);
  StillBeams still(source);
  EXPECT_EQ(packets_of(still).size(), 10u);
  EXPECT_EQ(still.left_out(), 0u);
}

}  // namespace
}  // namespace underbrush
