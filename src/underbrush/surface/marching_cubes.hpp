/// \file
/// This file has marching cubes, which turn the zero surface of a scalar field on a regular grid
/// into triangles.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush {
/// The fitters, which turn logs into models.
namespace surface {

/// Values at the nodes of a regular grid, with x fastest. Node (i, j, k) of the array lies at
/// (first + (i, j, k)) · cell, so that grids of neighbouring tiles share the same nodes to the bit.
struct ScalarGrid {
  std::array<int, 3> first{};  ///< Place of the array's first node, in cells from zero.
  std::array<int, 3> size{};   ///< Number of nodes along each axis.
  double cell_m = 0;           ///< Side of a cell, m.
  std::vector<float> value;    ///< NaN where the field is unknown.

  /// The index in `value` of node (i, j, k) of the array.
  size_t at(int i, int j, int k) const {
    return (size_t(k) * size_t(size[1]) + size_t(j)) * size_t(size[0]) + size_t(i);
  }
  /// The coordinate of node `i` of the array along `axis`, m.
  float place(int axis, int i) const { return float((first[size_t(axis)] + i) * cell_m); }
};

/// A mesh whose triangles share vertices. Triangles are counter-clockwise seen from the side of
/// positive values.
struct IsoMesh {
  std::vector<Vec3f> vertices;  ///< m.
  std::vector<std::array<uint32_t, 3>> triangles;
};

/// The triangles of a cell for one of the 256 sign patterns of its corners; each is a triple of
/// edges. Corner c lies at (c & 1, c >> 1 & 1, c >> 2), and bit c of the pattern is set where the
/// value is negative. Edge 4 a + m runs along axis a; bits 0 and 1 of m are its place along the
/// next two axes in cyclic order.
using CubeTriangles = std::vector<std::array<uint8_t, 3>>;

/// The triangles of all patterns. On each face, the crossed edges are joined so that negative
/// corners of an ambiguous face stay apart. The two cells at a face therefore see the same
/// segments, and the surface has no cracks.
const std::array<CubeTriangles, 256>& cube_triangles();

/// Computes the lower and the upper corner of an edge.
std::array<int, 2> cube_edge(int edge);

/// Computes the zero surface by marching cubes with linear interpolation along the edges. Cells
/// with a NaN corner are left out, and zero counts as positive. Throws `std::invalid_argument` for
/// a grid whose sizes are negative or do not fit its values.
IsoMesh marching_cubes(const ScalarGrid& grid);

}  // namespace surface
}  // namespace underbrush
