/// \file
/// Libraries: sets of primitives of many logs that were merged, and the search in them.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "underbrush/core/option.hpp"
#include "underbrush/elements/classes.hpp"
#include "underbrush/library/edits.hpp"
#include "underbrush/primitives/primitive_set.hpp"

namespace underbrush {
/// Libraries of primitives of many logs.
namespace library {

/// The kinds of objects and their names.
inline constexpr std::pair<std::string_view, elements::ClassKind> kKindNames[] = {
    {"shrub", elements::ClassKind::kShrub},
    {"tree", elements::ClassKind::kTree},
    {"patch", elements::ClassKind::kPatch}};

/// The options of the search for primitives and of the merge of sets.
struct Options {
  /// Names of classes, or of their kinds (`kKindNames`); empty = all.
  std::vector<std::string> classes;
  double least_height_m = 0, most_height_m = 1000;
  double least_width_m = 0, most_width_m = 1000;  ///< m; limits of the longer side of the box.
  std::string site, season, sensor;               ///< Their names; empty = any.
  std::string name;                               ///< A part of the given name; empty = any.
  /// The site, season and licence of each set that is merged, or of all if there is one text; empty
  /// = those of the set itself.
  std::vector<std::string> of_site, of_season, of_license;
  std::string edits;  ///< File of a list of edits of the one set (`apply_edits`); empty = none.
  bool keep_duplicates = false;
};

/// The options: those of the search in the group `Search`, and those of the merge.
std::span<const Option<Options>> options();

/// A primitive that was found.
struct Found {
  size_t entry = 0;                    ///< Its number in the set.
  std::string name;                    ///< CLASS/NUMBER, which is its folder in the set.
  double height_m = 0, width_m = 0;    ///< The height of its box, and its longer side from above.
  primitives::PrimitiveOrigin origin;  ///< Empty texts where the set has no origins.
  std::string given_name;              ///< The name that a person gave it, if any.
};

/// Returns the primitives of a set that the options select, in its order. Throws
/// `std::invalid_argument` for a class that does not exist.
std::vector<Found> find_primitives(const primitives::PrimitiveSet& set, const Options& options);

/// A library in memory, and the counts of its merge.
struct Merged {
  std::vector<primitives::Primitive> primitives;
  std::vector<primitives::PrimitiveOrigin> origins;
  double cell_m = 2;
  EditCounts edits;
  size_t not_wanted = 0;       ///< Primitives that are not searched for.
  size_t duplicates = 0;       ///< Primitives that the library has twice, left out or kept.
  size_t without_license = 0;  ///< Origins whose licence is not known.
};

/// Merges sets into a library. Each primitive keeps its origin (`PrimitiveOrigin`); a set that is a
/// library keeps its origins. Two primitives of a class are duplicates if their elements are equal,
/// or if they were cut in different sets from the same plant of a site that has a name: the middle
/// of each one's box lies in the other's. Of duplicates that of most points stays, with the name of
/// the other if it has none. Edits change what the set has before anything else is done. Throws
/// `FormatError` where a set is damaged, its cells have another side than those of the first, or
/// edits cannot be applied, and `std::invalid_argument` where there are edits and several sets, or
/// neither one nor as many sites, seasons or licences as sets.
Merged merge_sets(std::span<const std::filesystem::path> folders, const Options& options);

}  // namespace library
}  // namespace underbrush
