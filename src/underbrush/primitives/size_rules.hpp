/// \file
/// Rules that give an object its class by its size.
#pragma once
#include "underbrush/elements/classes.hpp"

namespace underbrush {
/// Objects of a labelled log, the primitives cut from them, and scenes composed of primitives.
namespace primitives {

/// Heights (m above the ground, as far as the sensor measured) at which one class ends and the next
/// begins. The defaults are those of `elements::shrub_class` and `elements::tree_class`.
struct SizeRules {
  double tree_m = 3;           ///< Objects at least this high are trees, lower ones shrubs.
  double small_shrub_m = 0.5;  ///< low < small_shrub_m ≤ small < medium_shrub_m ≤ medium < …
  double medium_shrub_m = 1;
  double large_shrub_m = 2;
  double medium_tree_m = 6;  ///< small < medium_tree_m ≤ medium < large_tree_m ≤ large
  double large_tree_m = 10;
  double patch_m = 4;  ///< Shrubs whose longer side is at least this (m) are a patch.
};

/// Returns the class of a shrub, or of a patch of shrubs, of that height (m).
inline elements::Class shrub_class(const SizeRules& r, double height_m, bool patch) {
  using enum elements::Class;
  if (height_m < r.small_shrub_m) return patch ? kLowShrubPatch : kLowShrub;
  if (height_m < r.medium_shrub_m) return patch ? kSmallShrubPatch : kSmallShrub;
  if (height_m < r.large_shrub_m) return patch ? kMediumShrubPatch : kMediumShrub;
  return patch ? kLargeShrubPatch : kLargeShrub;
}

/// Returns the class of a tree of that height (m).
inline elements::Class tree_class(const SizeRules& r, double height_m) {
  using enum elements::Class;
  if (height_m < r.medium_tree_m) return kSmallTree;
  return height_m < r.large_tree_m ? kMediumTree : kLargeTree;
}

}  // namespace primitives
}  // namespace underbrush
