/// \file
/// The weights of keyframes, learnt from beams.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "underbrush/elements/keyframes.hpp"
#include "underbrush/keyframes/keyframe_cache.hpp"

namespace underbrush::keyframes {

/// The pixels found for a beam beside its outcome, and the likelihood of the elements. The array
/// has a number for each place in `KeyframeWeights::pixel`, and the sets have a bit for each.
struct WeightSample {
  static constexpr size_t kPixels = elements::KeyframeWeights::kPixels;

  std::array<float, kPixels> off_m{};  ///< Range minus the pixel's, m, where both returned.
  uint8_t hit = 0;                     ///< The places where both returned.
  uint8_t missed = 0;                  ///< The places where both did not.
  uint8_t unseen = 0xff;               ///< The places where no pixel is found.
  size_t situation = 0;
  double elements = 0;  ///< Density (1/m) or probability of the outcome.
  double outlier = 0;   ///< The part of the outliers in it.

  /// `range_m` is infinite for a miss.
  WeightSample(const CachedPixels& found, double range_m);
};

/// Finds the most likely weights in every situation, by expectation and maximisation. At a distance
/// with too few beams the weights are those of `earlier`, or without it those of the next farther
/// distance. A place of `KeyframeWeights::pixel` in which next to no beam has a pixel leaves its
/// weight to the elements. The result has the same bits for any number of threads.
std::array<elements::KeyframeWeights, elements::Keyframes::kSituations> most_likely_weights(
    const std::vector<WeightSample>& samples,
    const std::array<elements::KeyframeWeights, elements::Keyframes::kSituations>* earlier =
        nullptr);

}  // namespace underbrush::keyframes
