#include "underbrush/core/beam_log.hpp"

#include <gtest/gtest.h>

namespace underbrush {
namespace {

BeamLog three_beams() {
  BeamLog log;
  log.extra["class"] = std::vector<uint16_t>{};
  log.info.max_range_m = 50;
  log.resize(3);
  log.range_m = {1, kMiss, 3};
  log.ring = {4, 5, 6};
  std::get<std::vector<uint16_t>>(log.extra["class"]) = {7, 8, 9};
  return log;
}

TEST(BeamLog, NewBeamsAreMisses) {
  BeamLog log;
  log.resize(2);
  EXPECT_FALSE(log.is_hit(1));
  EXPECT_NEAR(log.direction[1].norm(), 1, 0);
  EXPECT_EQ(log.end_point(0).x(), log.info.max_range_m);
}

TEST(BeamLog, AppendCarriesAllColumns) {
  const BeamLog log = three_beams();
  BeamLog out;
  out.append(log, 1, 3);
  out.append(log, 0);
  out.check();
  EXPECT_EQ(out.ring, (std::vector<uint16_t>{5, 6, 4}));
  EXPECT_EQ(std::get<std::vector<uint16_t>>(out.extra.at("class")),
            (std::vector<uint16_t>{8, 9, 7}));
}

TEST(BeamLog, AppendOfALogWithoutAColumnFillsZeros) {
  BeamLog out = three_beams(), other;
  other.resize(1);
  out.append(other, 0);
  out.check();
  EXPECT_EQ(std::get<std::vector<uint16_t>>(out.extra.at("class")).back(), 0);
}

TEST(BeamLog, KeepsTheFirstEchoOfEachBeamWhateverTypeTheColumnHas) {
  BeamLog log = three_beams();
  BeamLog same = log;
  keep_first_echoes(same);
  EXPECT_EQ(same.ring, log.ring);
  log.extra[kEchoColumn] = std::vector<int32_t>{1, 2, 0};
  keep_first_echoes(log);
  EXPECT_EQ(log.ring, (std::vector<uint16_t>{4, 6}));
  EXPECT_EQ(std::get<std::vector<int32_t>>(log.extra.at(kEchoColumn)),
            (std::vector<int32_t>{1, 0}));
  log.check();
}

TEST(MemorySource, GivesAllBeamsInOrderAndAgain) {
  const BeamLog log = three_beams();
  MemorySource source(log, 2);
  BeamLog chunk;
  for (int pass = 0; pass < 2; ++pass) {
    source.rewind();
    ASSERT_TRUE(source.next(chunk));
    EXPECT_EQ(chunk.ring, (std::vector<uint16_t>{4, 5}));
    ASSERT_TRUE(source.next(chunk));
    EXPECT_EQ(chunk.ring, (std::vector<uint16_t>{6}));
    EXPECT_FALSE(source.next(chunk));
    EXPECT_TRUE(chunk.empty());
  }
}

}  // namespace
}  // namespace underbrush
