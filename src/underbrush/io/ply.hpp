/// \file
/// PLY as a table of columns: ASCII and both binary byte orders in; binary little-endian out.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::io {

/// One PLY element. `columns` keeps the file's order and types; a list property `vertex_indices`
/// (or `vertex_index`) comes as `triangles`, polygons being split into fans. Other lists are
/// skipped.
struct PlyElement {
  std::string name;
  size_t count = 0;
  std::vector<std::pair<std::string, ExtraColumn>> columns;
  std::vector<std::array<uint32_t, 3>> triangles;

  /// The column, or nullptr.
  const ExtraColumn* find(const std::string& column) const;
};

/// A PLY file in memory.
struct PlyData {
  std::vector<std::string> comments;
  std::vector<PlyElement> elements;
  const PlyElement* find(const std::string& element) const;
};

/// Throws `FormatError` (file, place, reason) on anything that is not a whole PLY file.
PlyData read_ply(const std::filesystem::path& path);
/// Written atomically. `triangles`, where not empty, are written as `list uchar int
/// vertex_indices`.
void write_ply(const std::filesystem::path& path, const PlyData& data);

}  // namespace underbrush::io
