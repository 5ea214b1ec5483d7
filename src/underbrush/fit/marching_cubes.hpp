/// \file
/// The zero surface of a scalar field on a regular grid, as triangles.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush {
/// Fitting of scene elements to logs.
namespace fit {

/// Values at the nodes of a regular grid, x fastest. Node (i, j, k) of the array lies at
/// ((first + (i, j, k)) · cell), so that grids of neighbouring tiles share nodes bit for bit.
struct ScalarGrid {
  std::array<int, 3> first{};  ///< Of the array's first node, in cells.
  std::array<int, 3> size{};   ///< Nodes along each axis.
  double cell_m = 0;
  std::vector<float> value;  ///< NaN where the field is not known.

  size_t at(int i, int j, int k) const {
    return (size_t(k) * size_t(size[1]) + size_t(j)) * size_t(size[0]) + size_t(i);
  }
  /// Coordinate of node `i` of the array along `axis`, m.
  float place(int axis, int i) const { return float((first[size_t(axis)] + i) * cell_m); }
};

/// Triangles that share vertices, counter-clockwise seen from the side of positive values.
struct IsoMesh {
  std::vector<Vec3f> vertices;  ///< m.
  std::vector<std::array<uint32_t, 3>> triangles;
};

/// Triangles of one of the 256 sign patterns of a cell: triples of edges. Corner c lies at (c & 1,
/// c >> 1 & 1, c >> 2); bit c of the pattern is set where the value is negative. Edge 4 a + m runs
/// along axis a; bits 0 and 1 of m are its place along the two axes after a (cyclic).
using CubeTriangles = std::vector<std::array<uint8_t, 3>>;

/// All patterns. Made by joining, on each face, the crossed edges so that negative corners of an
/// ambiguous face stay apart: the two cells at a face see the same segments, so no cracks.
const std::array<CubeTriangles, 256>& cube_triangles();

/// Corners (lower, upper) of an edge of the numbering above.
std::array<int, 2> cube_edge(int edge);

/// Marching cubes with linear interpolation along the edges. Cells with a corner that is NaN are
/// left out. Zero counts as positive.
IsoMesh marching_cubes(const ScalarGrid& grid);

}  // namespace fit
}  // namespace underbrush
