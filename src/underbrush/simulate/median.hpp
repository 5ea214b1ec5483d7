/// \file
/// Answers without a draw: the median of the ranges that a beam may measure.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "underbrush/keyframes/keyframe_cache.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::simulate {

/// The answer to a beam: the return of a pixel of a keyframe, of an element, or a miss.
struct BeamAnswer {
  double range_m = 0;         ///< m; of an element.
  trace::Intersection met{};  ///< The element; none for a miss and where a pixel answers.
  std::optional<keyframes::CachedReturn> cached{};
  std::optional<Vec3f> direction{};  ///< Set where a drawn point lies off the beam.
};

/// Answers each ray with the median of its returns under the mixture of the elements that it meets
/// and of the pixels of keyframes (`trace::RangeMixture`, `elements::KeyframeWeights`), or with a
/// miss where that is likelier than a return. This is the answer of the least expected error in
/// range. `cache` may be null.
std::vector<BeamAnswer> median_answers(const trace::World& world,
                                       const keyframes::KeyframeCache* cache,
                                       std::span<const Ray> rays, std::span<const uint16_t> rings,
                                       const trace::RangeLimits& limits);

}  // namespace underbrush::simulate
