#include "underbrush/metrics/beams_by_place.hpp"

#include <gtest/gtest.h>

#include <random>

namespace underbrush::metrics {
namespace {

Vec3 random_vector(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> at(-size, size);
  return {at(random), at(random), at(random)};
}

/// Beams to ends all around, near ones too, and every tenth of them a miss.
BeamLog beams_all_around(std::mt19937& random) {
  BeamLog log;
  log.resize(20000);
  for (size_t i = 0; i < log.size(); ++i) {
    const Vec3 to = random_vector(random, i % 3 ? 30 : 3);
    log.direction[i] = to.normalized().cast<float>();
    log.range_m[i] = i % 10 ? float(to.norm()) : kMiss;
  }
  return log;
}

TEST(BeamsByPlace, SeesWhatALookAtEveryBeamSeesInTheSameOrder) {
  std::mt19937 random(7);
  const BeamLog log = beams_all_around(random);
  std::vector<uint32_t> rows;
  for (uint32_t i = 0; i < log.size(); i += 2) rows.push_back(uint32_t(log.size()) - 1 - i);
  const BeamsByPlace beams(log, rows);
  size_t seen = 0;
  for (int round = 0; round < 300; ++round) {
    const Vec3 place = random_vector(random, round % 2 ? 20 : 2);
    Eigen::AlignedBox3f box(Vec3f(random_vector(random, 1).normalized().cast<float>()));
    const float margin = round % 5 ? 0.05F : 0.5F;
    box.min().array() -= margin;
    box.max().array() += margin;
    std::vector<uint32_t> expected;
    for (const uint32_t i : rows) {
      if (box.contains(Vec3f(direction_from(place, log, i).cast<float>()))) expected.push_back(i);
    }
    const SeenBeams found = beams.seen_from(place, box);
    ASSERT_EQ(found.row, expected);
    ASSERT_EQ(found.direction.size(), expected.size());
    seen += expected.size();
  }
  EXPECT_GT(seen, 10000u);
}

}  // namespace
}  // namespace underbrush::metrics
