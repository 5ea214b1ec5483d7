/// \file
/// The choice of the scans that become keyframes.
#pragma once
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/keyframes/keyframe_options.hpp"

namespace underbrush::keyframes {

/// Chooses among the places (m) of possible keyframes, in the order of time, of `bytes` each. The
/// choice is spread evenly over time, and fewer than 16 others lie nearer to each than
/// `options.spacing_m`: a sensor that stands repeats itself best where a scan of nearly the same
/// time is remembered, because poses drift. Where that would take too much memory, first fewer lie
/// near together, and then the spacing grows. Returns ascending numbers.
std::vector<size_t> chosen_keyframes(const std::vector<Vec3>& places,
                                     const KeyframeOptions& options, size_t bytes);

}  // namespace underbrush::keyframes
