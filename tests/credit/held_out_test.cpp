#include "underbrush/credit/held_out.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"

namespace underbrush::credit {
namespace {

BeamLog log_all_around(size_t beams) {
  BeamLog log;
  log.resize(beams);
  Stream random(16);
  for (size_t i = 0; i < beams; ++i) {
    const double azimuth = random.uniform(0, 2 * M_PI);
    log.direction[i] = Vec3f(float(std::cos(azimuth)), float(std::sin(azimuth)), 0);
    log.scan[i] = uint32_t(i / 10'000);
    log.range_m[i] = float(5 + random.uniform());
  }
  return log;
}

/// The beams that a source with these rules gives, each looked up in the rules.
size_t beams_of(const BeamLog& log, const HeldOut& held_out, BeamShare share, bool all_follow) {
  MemorySource source(log, 70'000);
  TrainingSource training(source, held_out, share);
  EXPECT_EQ(training.size(), log.size());
  size_t beams = 0;
  for (BeamLog chunk; training.next(chunk); beams += chunk.size()) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      EXPECT_FALSE(held_out(chunk, i));
      EXPECT_TRUE(!all_follow || share.has(chunk, i));
    }
  }
  return beams;
}

TEST(TrainingSource, HasAShareOfALongLogAndAllOfAShorterOne) {
  const HeldOut held_out;
  BeamLog log = log_all_around(kLongLog + 1);
  const size_t all = beams_of(log, held_out, {}, true);
  EXPECT_NEAR(double(all), 0.95 * double(log.size()), 0.01 * double(log.size()));
  const size_t half = beams_of(log, held_out, {2, 6}, true);
  EXPECT_NEAR(double(half), double(all) / 2, 3 * std::sqrt(double(all)));
  EXPECT_EQ(half + beams_of(log, held_out, {0, 2}, true) + beams_of(log, held_out, {6, 8}, true),
            all);
  log.resize(kLongLog / 4);
  EXPECT_EQ(beams_of(log, held_out, {2, 6}, false), beams_of(log, held_out, {}, true));
}

}  // namespace
}  // namespace underbrush::credit
