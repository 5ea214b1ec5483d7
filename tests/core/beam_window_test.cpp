#include "underbrush/core/beam_window.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace underbrush {
namespace {

BeamLog numbered_log(size_t n) {
  BeamLog log;
  log.extra["number"] = std::vector<uint32_t>{};
  log.resize(n);
  auto& numbers = std::get<std::vector<uint32_t>>(log.extra["number"]);
  std::iota(numbers.begin(), numbers.end(), 0);
  return log;
}

/// A source that begins at a multiple of three, and counts the beams that it gives.
class Seekable : public SeekableSource {
 public:
  explicit Seekable(const BeamLog& log) : log_(log) {}
  const LogInfo& info() const override { return log_.info; }
  size_t size() const override { return log_.size(); }
  void rewind() override { at_ = 0; }
  size_t seek(size_t beam) override { return at_ = std::min(beam, size()) / 3 * 3; }
  bool next(BeamLog& chunk) override {
    chunk = log_.like();
    if (at_ == size()) return false;
    const size_t end = std::min(at_ + 4, size());
    chunk.append(log_, at_, end);
    given += chunk.size();
    at_ = end;
    return true;
  }
  size_t given = 0;

 private:
  const BeamLog& log_;
  size_t at_ = 0;
};

std::vector<uint32_t> numbers_in(BeamSource& source) {
  std::vector<uint32_t> out;
  source.rewind();
  for (BeamLog chunk; source.next(chunk);) {
    EXPECT_FALSE(chunk.empty());
    chunk.check();
    const auto& part = std::get<std::vector<uint32_t>>(chunk.extra.at("number"));
    out.insert(out.end(), part.begin(), part.end());
  }
  return out;
}

TEST(BeamWindow, HasTheBeamsOfItsSourceWhateverTheChunks) {
  const BeamLog log = numbered_log(13);
  for (size_t first = 0; first <= 14; ++first) {
    for (size_t end = first; end <= 15; ++end) {
      std::vector<uint32_t> expected(std::min<size_t>(end, 13) - std::min<size_t>(first, 13));
      std::iota(expected.begin(), expected.end(), uint32_t(first));
      for (const size_t chunk : {1, 4, 13, 20}) {
        MemorySource source(log, chunk);
        BeamWindow window(source, first, end);
        EXPECT_EQ(window.size(), expected.size());
        EXPECT_EQ(numbers_in(window), expected) << first << ":" << end << " by " << chunk;
        EXPECT_EQ(numbers_in(window), expected) << "read again";
      }
      Seekable source(log);
      BeamWindow window(source, first, end);
      EXPECT_EQ(numbers_in(window), expected) << first << ":" << end;
      EXPECT_LE(source.given, expected.size() + 6) << "beams before the window were made";
    }
  }
}

}  // namespace
}  // namespace underbrush
