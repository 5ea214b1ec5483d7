/// \file
/// This file makes an opaque surface through all points of a log. It is the everyday baseline; the
/// implicit surface is a parameter.
#pragma once
#include <span>

#include "underbrush/surface/implicit.hpp"
#include "underbrush/surface/marching_cubes.hpp"

namespace underbrush {
/// Opaque surfaces through points: implicit surfaces and marching cubes.
namespace surface {

/// The parameters of `surface_tile`. [deschaud12] §V has cells of 0.3 m and a kernel of 0.4 m for a
/// mobile log, 0.01 m and 0.04 m for a standing scanner, and σ = 5 mm;
/// share/configs/vegetation-surface-*.yaml has them as files.
struct SurfaceOptions {
  double cell_m = 0.1;  ///< Side of a cell of the marching cubes, m.
  /// Bounds of the kernel radius, m. A point's radius is the first of kernel/2ⁿ, …, kernel/2,
  /// kernel that holds enough neighbours, so that the surface is as fine as the points are dense.
  /// It is at least `least_kernel_m` and at least two cells.
  double kernel_m = 0.8, least_kernel_m = 0.2;
  /// Points with fewer neighbours, itself included, after thinning are left out.
  int min_neighbours = 4;
  /// The surface ends where the weighted mean of the surrounding points lies farther off than this
  /// share of their radius. The mean is at 0 on a closed surface and at 0.24 at the edge of a half
  /// plane.
  double border = 0.3;
  /// σ of the simulated range, m; 0 takes the points' spread about the surface.
  double noise_m = 0;
  /// Whether to leave out triangles that more beams passed than ended at. Without it the mesh is
  /// opaque over all points.
  bool carve = false;
};

/// An area of the horizontal plane, m. It contains its lower edges and not its upper ones.
struct Area {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// The surface over one tile, with the residuals of the tile's points. Over all tiles, σ² = Σ
/// `sum_squares_m2` / Σ `points`.
struct SurfaceTile {
  IsoMesh mesh;
  double sum_squares_m2 = 0;  ///< Sum of the points' squared distances to the surface.
  size_t points = 0;          ///< Number of these points. Points far from the surface do not count.
};

/// Computes how far beyond a tile's area its points must reach so that neighbouring tiles join, m.
double surface_margin_m(const SurfaceOptions& options);

/// Computes the surface over the cells whose lower corner (a multiple of `cell_m`) lies in `core`.
///
/// Points are thinned to at most one mean for each half cell, so that near and far ground weigh the
/// same. Each mean gets the normal of a plane through its neighbours, turned towards `to_sensor`.
/// Marching cubes cut the zero surface of `distance`, which is trimmed at the border of the points
/// [adamson04], so that holes stay where there are no data and thin things get no rims.
///
/// `points` (m) and `to_sensor` (vectors of any length towards the sensor) are those of the tile
/// with its margin, in any order; points that are not finite are left out. Tiles whose areas abut
/// join without cracks, because their vertices on the common edge are the same to the bit. Throws
/// `std::invalid_argument` for lengths that differ, parameters that are not positive, a core that
/// is not finite, and cells so small that a tile would have more than 2²⁷.
SurfaceTile surface_tile(std::span<const Vec3f> points, std::span<const Vec3f> to_sensor,
                         const Area& core, const SurfaceOptions& options = {},
                         const SignedDistance& distance = imls);

}  // namespace surface
}  // namespace underbrush
