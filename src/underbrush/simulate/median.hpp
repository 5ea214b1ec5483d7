/// \file
/// Answers without a draw: the median of what a beam may measure.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "underbrush/keyframes/recollection.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::simulate {

/// The median of a beam's outcomes.
struct MedianAnswer {
  double range_m = 0;
  /// The element that is likeliest at this range; none for a miss, and where a pixel is likelier.
  trace::Intersection met{};
  std::optional<keyframes::RecalledReturn> seen;  ///< The pixel's answer, where it is likelier.
};

/// Answers each ray with the median of its returns under the mixture of the elements that it meets
/// and of what keyframes recall (`trace::RangeMixture`, `elements::KeyframeTrust`), or with a miss
/// where that is likelier than a return. This is the answer of the least expected error in range.
/// `memory` may be null.
std::vector<MedianAnswer> median_answers(const trace::World& world,
                                         const keyframes::Recollection* memory,
                                         std::span<const Ray> rays, std::span<const uint16_t> rings,
                                         const trace::RangeLimits& limits);

}  // namespace underbrush::simulate
