/// \file
/// A height map as triangles: many where the ground bends, few where it is flat.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "underbrush/ground/height_map.hpp"

namespace underbrush::ground {

/// Parameters of `triangulate`.
struct TriangulateOptions {
  double max_error_m =
      0.02;                ///< No node of the height map lies farther above or below the triangles.
  double max_side_m = 10;  ///< No side is longer, seen from above.
};

/// Triangles over the plane, facing up (counter-clockwise seen from above).
struct GroundMesh {
  Vec3 origin = Vec3::Zero();                      ///< m, world.
  std::vector<Vec3f> vertices;                     ///< m, relative to the origin.
  std::vector<std::array<uint32_t, 3>> triangles;  ///< Indices into `vertices`.
};

/// Delaunay triangulation ([tallavajhula18] §IV) of chosen nodes of the height map. The triangles
/// cover exactly the grid's cells whose four nodes exist, without cracks, overlaps or T-junctions.
/// Worked in tiles of 256 cells, in parallel; along tiles' borders and the covered area's edge
/// every node is kept, so that tiles join. Throws `std::invalid_argument` for an error that is
/// negative or a side shorter than a cell's diagonal.
GroundMesh triangulate(const HeightMap& map, const TriangulateOptions& options = {});

}  // namespace underbrush::ground
