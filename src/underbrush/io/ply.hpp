/// \file
/// Reader of PLY files (ASCII, and binary in both byte orders) as tables of columns, and a writer
/// (binary, little-endian).
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::io {

/// An element of a PLY file. `columns` keeps the file's order and types. A list property
/// `vertex_indices` (or `vertex_index`) becomes `triangles`, with polygons split into fans, whose
/// numbers of triangles are `fans`; other lists are skipped.
struct PlyElement {
  std::string name;
  size_t count = 0;
  std::vector<std::pair<std::string, ExtraColumn>> columns;
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<uint32_t> fans;  ///< One for each row that has such a list.

  /// Returns the column of that name, or nullptr.
  const ExtraColumn* find(const std::string& column) const;
};

/// A PLY file in memory.
struct PlyData {
  std::vector<std::string> comments;
  std::vector<PlyElement> elements;
  const PlyElement* find(const std::string& element) const;
};

/// Reads a PLY file. Throws `FormatError` (file, place, reason) for anything that is not a whole
/// PLY file.
PlyData read_ply(const std::filesystem::path& path);
/// Returns the element of that name. Throws `FormatError`, which calls the file `file`, where there
/// is none.
const PlyElement& element_of(const std::filesystem::path& file, const PlyData& data,
                             const std::string& name);
/// Returns the column of that name. Throws `FormatError`, which calls the file `file`, where there
/// is none, or where it is of another type than `T`.
template <class T>
const std::vector<T>& column_of(const std::filesystem::path& file, const PlyElement& element,
                                const std::string& name) {
  const ExtraColumn* column = element.find(name);
  const auto* values = column ? std::get_if<std::vector<T>>(column) : nullptr;
  if (!values) throw FormatError(file.string(), element.name, "no column " + name);
  return *values;
}

/// Writes a PLY file, atomically. `triangles`, where not empty, become `list uchar int
/// vertex_indices`. Throws `IoError`.
void write_ply(const std::filesystem::path& path, const PlyData& data);

}  // namespace underbrush::io
