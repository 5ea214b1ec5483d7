/// \file
/// Edits of the primitives of a set, and the files that list them.
#pragma once
#include <filesystem>
#include <string>

#include "underbrush/elements/classes.hpp"
#include "underbrush/primitives/primitive_set.hpp"

namespace underbrush::library {

/// The most bytes of the name that a person gives to a primitive.
inline constexpr size_t kMostNameBytes = 200;

/// The numbers of primitives that a list of edits concerns.
struct EditCounts {
  size_t thrown_out = 0, relabelled = 0, named = 0;
};

/// Whether a person may give a primitive of one class the other one. Plants, which are shrubs and
/// trees, do not become cells of patches, nor the other way round, because these are placed cell by
/// cell.
bool may_become(elements::Class from, elements::Class to);

/// Applies a list of edits to the entries of a set on disk. The list is JSON after the schema
/// share/schemas/primitive-edits.json; its edits name primitives by their folders in the set, each
/// at most once, so that their order does not matter. Entries that are thrown out are removed, and
/// the folders of the others keep their names. Throws `FormatError` with the place of what cannot
/// be applied, such as "edits[3].class", also where the list has the hash of another set or throws
/// out all primitives.
EditCounts apply_edits(primitives::PrimitiveSet& set, const std::filesystem::path& list);
/// Applies the list of edits that is the content of a file of this path.
EditCounts apply_edits(primitives::PrimitiveSet& set, const std::string& list,
                       const std::filesystem::path& path);

/// Returns the hash of a set on disk by which a list of edits may name the set that it is for.
std::string hash_of_set(const primitives::PrimitiveSet& set);

}  // namespace underbrush::library
