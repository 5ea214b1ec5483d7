/// \file
/// The options of keyframes.
#pragma once
#include <cstddef>

#include "underbrush/credit/held_out.hpp"

namespace underbrush::keyframes {

/// The options of `learn_keyframes`.
struct KeyframeOptions {
  /// m; a scan becomes a keyframe where fewer than 16 keyframes lie nearer. 0 = no keyframes.
  double spacing_m = 2;
  /// Returns nearer than this (m) are unknown, because they are of the vehicle.
  double min_range_m = 0;
  /// The most memory of the keyframes, bytes. Until they fit, fewer may lie nearer, at least 2, and
  /// then the spacing grows.
  size_t most_bytes = size_t(1) << 28;
  /// Beams that the weights are learnt from, in each half of the columns if the log has one scan.
  size_t samples = 60'000;
  /// The beams from which the elements were not learnt. The weights are learnt from these beams
  /// alone if they are at least a quarter of `samples`, because the elements fit their training
  /// beams too well.
  credit::HeldOut held_out{0};
};

}  // namespace underbrush::keyframes
