/// \file
/// A set of primitives on disk, which a person can browse: one folder a class, in it one a
/// primitive. Layout: docs/reference/formats.md.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/primitives/extract.hpp"

namespace underbrush::primitives {

/// Version of the layout that is written; newer ones are refused.
inline constexpr int kPrimitiveSetVersion = 1;

/// What the manifest says of a primitive.
struct PrimitiveEntry {
  elements::Class label = elements::Class::kUnknown;
  Box box;
  std::string name;  ///< CLASS/NUMBER: its folder in the set.
  size_t elements = 0, points = 0;
};

/// A set's manifest; the elements are read when they are needed.
struct PrimitiveSet {
  std::filesystem::path folder;
  double cell_m = 2;  ///< Side of the cells of patches.
  std::vector<PrimitiveEntry> entries;
  std::string provenance;
  /// One an entry, where the set is in memory and in no folder; else empty.
  std::vector<elements::Model> models = {};
};

/// The set that `write_primitives` would write, in memory.
PrimitiveSet primitive_set(std::vector<Primitive> primitives, double cell_m);

/// Writes the folder `path`, atomically; a set that stood there is replaced: primitives.json,
/// index.html (a contact sheet that loads nothing else), CLASS/NUMBER/ as a model folder with
/// primitive.json and thumbnail.png. Throws `IoError`, also if a folder that is no set stands
/// there.
void write_primitives(const std::filesystem::path& path, const std::vector<Primitive>& primitives,
                      double cell_m, const std::string& provenance);

/// Throws the `IoError` that `write_primitives` would end with now.
void check_primitives_output(const std::filesystem::path& path);

/// Reads the manifest. Throws `FormatError` where it is not whole, or names a folder that is not
/// there.
PrimitiveSet read_primitive_set(const std::filesystem::path& path);

/// The elements of an entry, read where they are not in memory. Throws `FormatError`.
elements::Model read_primitive(const PrimitiveSet& set, size_t entry);

}  // namespace underbrush::primitives
