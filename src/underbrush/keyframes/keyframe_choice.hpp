/// \file
/// The choice of the scans that become keyframes.
#pragma once
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/keyframes/keyframe_options.hpp"

namespace underbrush::keyframes {

/// Chooses among the places (m) of possible keyframes, in the order of time, of `bytes` each. The
/// choice is spread evenly over time, and fewer than 16 others lie nearer to each than
/// `options.spacing_m`: the best cache of a sensor that stands still has scans of nearly the same
/// time, because poses drift. Where that would take too much memory, first fewer keyframes lie near
/// together, and then the spacing grows. Returns ascending numbers.
std::vector<size_t> chosen_keyframes(const std::vector<Vec3>& places,
                                     const KeyframeOptions& options, size_t bytes);

}  // namespace underbrush::keyframes
