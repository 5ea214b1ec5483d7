/// \file
/// Triangulation of a height map: small triangles where the ground bends, large ones where it is
/// flat.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "underbrush/ground/height_map.hpp"

namespace underbrush::ground {

/// Options of `triangulate`.
struct TriangulateOptions {
  double max_error_m =
      0.01;                ///< No node of the height map lies farther above or below the triangles.
  double max_side_m = 10;  ///< m; no side is longer, seen from above.
};

/// A ground mesh whose triangles face up (counter-clockwise seen from above).
struct GroundMesh {
  Vec3 origin = Vec3::Zero();                      ///< m, world.
  std::vector<Vec3f> vertices;                     ///< m, relative to the origin.
  std::vector<std::array<uint32_t, 3>> triangles;  ///< Indices into `vertices`.
};

/// Triangulates chosen nodes of the height map by Delaunay's criterion ([tallavajhula18] §IV). The
/// triangles cover exactly the grid's cells whose four nodes exist, without cracks, overlaps or
/// T-junctions. Tiles of 256 cells are triangulated in parallel; along their borders and the edge
/// of the covered area every node is kept, so that tiles join. Throws `std::invalid_argument` for a
/// negative error or a side shorter than a cell's diagonal.
GroundMesh triangulate(const HeightMap& map, const TriangulateOptions& options = {});

}  // namespace underbrush::ground
