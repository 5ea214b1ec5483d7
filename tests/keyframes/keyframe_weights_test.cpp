#include "underbrush/keyframes/keyframe_weights.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"

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
      samples.reserve(30000);
      for (int k = 0; k < sky; ++k) samples.push_back(sample(false, 1));
      for (int k = 0; k < 10000; ++k) samples.push_back(sample(k < 5000 * weight, 0.5));
      EXPECT_NEAR(most_likely_weights(samples)[0].elements, weight, 0.02) << sky;
    }
  }
}

/// An expectation and a maximisation of the weights, sample by sample in double precision.
elements::KeyframeWeights next_by_definition(const std::vector<WeightSample>& samples,
                                             const elements::KeyframeWeights& t) {
  elements::KeyframeWeights sum;
  sum.elements = 0;
  sum.sigma_m.fill(0);
  for (const WeightSample& s : samples) {
    double parts[WeightSample::kPixels][elements::KeyframeWeights::kScales] = {};
    double of_elements = t.elements * s.elements, total = s.outlier + of_elements;
    std::array<double, WeightSample::kPixels> pixel{};
    for (size_t r = 0; r < pixel.size(); ++r) {
      if (s.unseen >> r & 1) pixel[r] = t.pixel[r] * s.elements;
      for (size_t c = 0; c < t.scale.size(); ++c) {
        const double sigma = t.sigma_m[c], off = double(s.off_m[r]) / sigma;
        const double bell = std::exp(-0.5 * off * off) / (std::sqrt(2 * M_PI) * sigma);
        const double density = (s.hit >> r & 1 ? bell : 0) + (s.missed >> r & 1);
        parts[r][c] = t.pixel[r] * t.scale[c] * density;
        pixel[r] += parts[r][c];
      }
      total += pixel[r];
    }
    sum.elements += of_elements / total;
    for (size_t r = 0; r < pixel.size(); ++r) {
      sum.pixel[r] += pixel[r] / total;
      for (size_t c = 0; c < t.scale.size(); ++c) {
        if (!(s.hit >> r & 1)) continue;
        const double off = double(s.off_m[r]);
        sum.scale[c] += parts[r][c] / total;
        sum.sigma_m[c] += parts[r][c] / total * off * off;
      }
    }
  }
  double weights = sum.elements, returns = 0;
  for (const double w : sum.pixel) weights += w;
  for (const double c : sum.scale) returns += c;
  sum.elements /= weights;
  for (double& w : sum.pixel) w /= weights;
  for (size_t c = 0; c < sum.scale.size(); ++c) {
    sum.sigma_m[c] = std::sqrt(sum.sigma_m[c] / sum.scale[c]);
    sum.scale[c] /= returns;
  }
  return sum;
}

// The weights do not change in a step of the definition.
TEST(KeyframeWeights, AreAFixedPointOfTheirDefinition) {
  Stream random(57);
  std::vector<WeightSample> samples;
  samples.reserve(40000);
  for (int k = 0; k < 40000; ++k) {
    CachedPixels found;
    const bool returns = random.uniform() < 0.7;
    for (uint8_t r = 0; r < WeightSample::kPixels; ++r) {
      if (random.uniform() < 0.1 * r) continue;  // not found
      const double noise = random.uniform() < 0.5 ? 0.03 : 0.3;
      const bool agrees = random.uniform() < 0.9 - 0.05 * r;
      found.rank[found.count] = r;
      found.range_m[found.count++] = agrees == returns ? 10 + noise * random.normal() : INFINITY;
    }
    WeightSample s(found, returns ? 10 : INFINITY);
    s.elements = random.uniform(0.01, 0.6);
    s.outlier = 1e-3;
    samples.push_back(s);
  }
  const elements::KeyframeWeights t = most_likely_weights(samples)[0];
  const elements::KeyframeWeights next = next_by_definition(samples, t);
  EXPECT_NEAR(next.elements, t.elements, 2e-3);
  for (size_t r = 0; r < t.pixel.size(); ++r) EXPECT_NEAR(next.pixel[r], t.pixel[r], 2e-3) << r;
  for (size_t c = 0; c < t.scale.size(); ++c) {
    EXPECT_NEAR(next.scale[c], t.scale[c], 5e-3) << c;
    EXPECT_NEAR(next.sigma_m[c], t.sigma_m[c], 0.02 * t.sigma_m[c]) << c;
  }
}

}  // namespace
}  // namespace underbrush::keyframes
