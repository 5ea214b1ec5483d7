/// \file
/// Annotations: the classes, poses and boxes of a site's objects, a = {(c_k, q_k, box_k)} of
/// [tallavajhula18] §IV.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/elements/model.hpp"
#include "underbrush/primitives/placed_object.hpp"

namespace underbrush::primitives {

/// Version of the file that is written; newer versions are refused.
inline constexpr int kAnnotationVersion = 1;

/// The objects of a site and its ground, without the elements of the objects.
struct Annotation {
  std::filesystem::path ground;  ///< A model folder, whose ground is taken.
  std::vector<PlacedObject> objects;
  std::string provenance;  ///< JSON object.
};

/// Writes the annotation as JSON (share/schemas/annotation.json), atomically. The path `ground` is
/// written relative to the file's folder. Throws `IoError`.
void write_annotation(const std::filesystem::path& path, const Annotation& annotation);

/// Writes the annotation, and its ground to the folder that it names; either both appear or none.
/// Throws `IoError`.
void write_annotation(const std::filesystem::path& path, const Annotation& annotation,
                      elements::Model ground);

/// Reads and validates an annotation. Throws `FormatError` with the place in the file
/// ("objects[3].class") for an unknown class, a box without extent, a value that is not a finite
/// number, and a member that is missing or unknown to the schema; unless `outside`, also for a
/// ground or trajectory that lies outside the annotation's folder.
Annotation read_annotation(const std::filesystem::path& path, bool outside = false);

}  // namespace underbrush::primitives
