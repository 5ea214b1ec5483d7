/// \file
/// What stands where on a site: a = {(c_k, q_k, box_k)} of [tallavajhula18] §IV.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/primitives/placed_object.hpp"

namespace underbrush::primitives {

/// Version of the file that is written; newer ones are refused.
inline constexpr int kAnnotationVersion = 1;

/// A site without its plants' elements.
struct Annotation {
  std::filesystem::path ground;  ///< A model folder, of which the ground is taken.
  std::vector<PlacedObject> objects;
  std::string provenance;  ///< JSON object.
};

/// Writes the annotation as JSON (share/schemas/annotation.json), atomically; `ground` as it is
/// seen from the file's folder.
void write_annotation(const std::filesystem::path& path, const Annotation& annotation);

/// Reads and validates. Throws `FormatError` with the place in the file ("objects[3].class") for an
/// unknown class, a box without extent, a value that is no finite number, a member that is missing
/// or that the schema does not know.
Annotation read_annotation(const std::filesystem::path& path);

}  // namespace underbrush::primitives
