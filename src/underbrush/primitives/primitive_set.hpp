/// \file
/// Sets of primitives on disk, which a person can browse: a folder for each class, and in it a
/// folder for each primitive. Layout: docs/reference/formats.md.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/primitives/extract.hpp"
#include "underbrush/primitives/primitive_entry.hpp"

namespace underbrush::primitives {

/// Version of the layout that is written; newer versions are refused.
inline constexpr int kPrimitiveSetVersion = 1;

/// The origin of primitives of a library. Unknown texts are empty.
struct PrimitiveOrigin {
  std::string set;         ///< Name of the folder of the set that was merged.
  std::string site;        ///< Name of the site of its log.
  std::string season;      ///< Season in which the log was recorded.
  std::string sensor;      ///< Name of the sensor that recorded it.
  std::string license;     ///< Licence of the log.
  std::string provenance;  ///< JSON object: the provenance of the set.
};

/// The manifest of a set. The elements of its primitives are read when they are needed.
struct PrimitiveSet {
  std::filesystem::path folder;
  double cell_m = 2;  ///< m; side of the cells of patches.
  std::vector<PrimitiveEntry> entries;
  std::string provenance;
  std::vector<PrimitiveOrigin> origins = {};  ///< There are none where the set is of one log.
  /// The model of each entry if the set is in memory and has no folder; else empty.
  std::vector<elements::Model> models = {};
};

/// Returns in memory the set that `write_primitives` would write.
PrimitiveSet primitive_set(std::vector<Primitive> primitives, double cell_m);

/// Writes the folder `path`, atomically, replacing a set that stood there: primitives.json,
/// index.html (a contact sheet that loads no other file), and for each primitive the model folder
/// CLASS/NUMBER/ with primitive.json and thumbnail.png. A model that has a provenance keeps it.
/// Throws `IoError`, also if a folder that is
/// not a set stands there.
void write_primitives(const std::filesystem::path& path, const std::vector<Primitive>& primitives,
                      double cell_m, const std::string& provenance,
                      const std::vector<PrimitiveOrigin>& origins = {});

/// Whether a path is the folder of a set of primitives.
bool is_primitive_set(const std::filesystem::path& path);
/// Throws the `IoError` that `write_primitives` would end with. Callers use it before a long
/// computation.
void check_primitives_output(const std::filesystem::path& path);

/// Reads the manifest of a set. Throws `FormatError` where it is damaged or names a folder that
/// does not exist.
PrimitiveSet read_primitive_set(const std::filesystem::path& path);

/// Returns the elements of an entry, read from disk unless they are in memory. Throws
/// `FormatError`.
elements::Model read_primitive(const PrimitiveSet& set, size_t entry);

/// Returns an entry of a set on disk with all data of its folder. Where the entry was given another
/// class than the folder has, the ellipsoids of that class get it, too. Throws `FormatError`.
Primitive read_whole_primitive(const PrimitiveSet& set, size_t entry);

}  // namespace underbrush::primitives
