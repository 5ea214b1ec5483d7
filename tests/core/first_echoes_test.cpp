#include "underbrush/core/first_echoes.hpp"

#include <gtest/gtest.h>

namespace underbrush {
namespace {

/// Beams with these echoes; rows of one beam have the range of their number.
BeamLog rows_of(const std::vector<uint8_t>& echo) {
  BeamLog log;
  log.resize(echo.size());
  for (size_t i = 0; i < echo.size(); ++i) {
    if (echo[i]) log.range_m[i] = float(echo[i]);
  }
  log.extra[kEchoColumn] = echo;
  return log;
}

TEST(FirstEchoes, AreThoseOfTheWholeLogWhateverTheChunks) {
  const BeamLog rows = rows_of({1, 2, 3, 0, 1, 2, 1, 1, 2, 3, 4, 0});
  BeamLog whole = rows;
  keep_first_echoes(whole);
  for (const size_t chunk_size : {1, 2, 3, 100}) {
    MemorySource source(rows, chunk_size);
    FirstEchoes first(source);
    EXPECT_EQ(first.size(), whole.size());
    for (int reading = 0; reading < 2; ++reading) {
      first.rewind();
      BeamLog all, chunk;
      while (first.next(chunk)) {
        EXPECT_FALSE(chunk.empty());
        for (size_t i = 0; i < chunk.size(); ++i) all.append(chunk, i);
      }
      EXPECT_EQ(all.range_m, whole.range_m);
    }
  }
}

TEST(FirstEchoes, WithoutEchoesEveryRowIsABeam) {
  BeamLog rows = rows_of({1, 0, 1});
  rows.extra.clear();
  MemorySource source(rows, 2);
  EXPECT_EQ(FirstEchoes(source).size(), 3u);
}

}  // namespace
}  // namespace underbrush
