/// \file
/// Classes of beams, points, elements and objects: one list for all stages.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace underbrush::elements {

/// The object classes of [tallavajhula18] §III, together with ground and grass. The numbers are
/// stored in files: append to the list, never renumber it.
enum class Class : uint8_t {
  kUnknown,
  kGround,
  kGrass,
  kLowShrub,
  kSmallShrub,
  kMediumShrub,
  kLargeShrub,
  kSmallTree,
  kMediumTree,
  kLargeTree,
  kLowShrubPatch,
  kSmallShrubPatch,
  kMediumShrubPatch,
  kLargeShrubPatch,
};

/// Names in files and on the command line, in the order of `Class`.
inline constexpr std::array<std::string_view, 14> kClassNames = {"unknown",
                                                                 "ground",
                                                                 "grass",
                                                                 "low_shrub",
                                                                 "small_shrub",
                                                                 "medium_shrub",
                                                                 "large_shrub",
                                                                 "small_tree",
                                                                 "medium_tree",
                                                                 "large_tree",
                                                                 "low_shrub_patch",
                                                                 "small_shrub_patch",
                                                                 "medium_shrub_patch",
                                                                 "large_shrub_patch"};

/// Returns the name of a class.
constexpr std::string_view name(Class c) { return kClassNames.at(size_t(c)); }

/// Returns the class of that name, or nothing.
constexpr std::optional<Class> class_from_name(std::string_view name) {
  for (size_t i = 0; i < kClassNames.size(); ++i) {
    if (kClassNames[i] == name) return Class(i);
  }
  return std::nullopt;
}

/// The kind of object that a class is a size of.
enum class ClassKind : uint8_t { kOther, kShrub, kTree, kPatch };

/// Returns shrub, tree or patch of shrubs; `kOther` for the classes that are not objects.
constexpr ClassKind kind_of(Class c) {
  if (c >= Class::kLowShrubPatch) return ClassKind::kPatch;
  if (c >= Class::kSmallTree) return ClassKind::kTree;
  return c >= Class::kLowShrub ? ClassKind::kShrub : ClassKind::kOther;
}

/// Returns the class of a shrub by its height (m): low < 0.5 ≤ small < 1 ≤ medium < 2 ≤ large.
constexpr Class shrub_class(double height_m) {
  if (height_m < 0.5) return Class::kLowShrub;
  if (height_m < 1) return Class::kSmallShrub;
  return height_m < 2 ? Class::kMediumShrub : Class::kLargeShrub;
}

/// Returns the class of a tree by its height (m): small < 6 ≤ medium < 10 ≤ large.
constexpr Class tree_class(double height_m) {
  if (height_m < 6) return Class::kSmallTree;
  return height_m < 10 ? Class::kMediumTree : Class::kLargeTree;
}

}  // namespace underbrush::elements
