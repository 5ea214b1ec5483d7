#include "underbrush/keyframes/keyframe_weights.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace underbrush::keyframes {
namespace {

// A beam beside eight pixels without a return. Its own return, if any, has the density 0.5 by the
// elements, and a miss the probability `elements`.
WeightSample sample(bool returns, double elements) {
  CachedPixels found;
  found.count = WeightSample::kPixels;
  for (size_t k = 0; k < found.count; ++k) {
    found.rank[k] = uint8_t(k);
    found.range_m[k] = INFINITY;
  }
  WeightSample s(found, returns ? 10 : INFINITY);
  s.elements = elements;
  return s;
}

// Elements that stop half of the beams, with the weight w beside pixels without a return, give a
// share w / 2 of the beams a return. Beams into the sky do not change the weight, however many they
// are, because elements and pixels agree on them.
TEST(KeyframeWeights, AreTheMostLikelyOnesBesideBeamsWithoutEvidence) {
  for (const double weight : {0.1, 0.8, 1.0}) {
    for (const int sky : {0, 20000}) {
      std::vector<WeightSample> samples;
      for (int k = 0; k < sky; ++k) samples.push_back(sample(false, 1));
      for (int k = 0; k < 10000; ++k) samples.push_back(sample(k < 5000 * weight, 0.5));
      EXPECT_NEAR(most_likely_weights(samples)[0].elements, weight, 0.02) << sky;
    }
  }
}

}  // namespace
}  // namespace underbrush::keyframes
