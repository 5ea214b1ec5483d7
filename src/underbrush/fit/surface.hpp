/// \file
/// An opaque surface through all points of a log: the everyday baseline, with the implicit surface
/// as a parameter.
#pragma once
#include <span>

#include "underbrush/fit/implicit.hpp"
#include "underbrush/fit/marching_cubes.hpp"

namespace underbrush::fit {

/// Parameters of `surface_tile`. The defaults are tuned like those of the default fitter
/// (docs/notebook/2026-11.md); [deschaud12] §V: cell 0.3 m and kernel 0.4 m for a mobile log, 0.01
/// m and 0.04 m for a standing scanner, σ = 5 mm (share/configs/vegetation-*.yaml).
struct SurfaceOptions {
  double cell_m = 0.1;  ///< Cell of the marching cubes.
  /// The radius within which a point's neighbours make its normal, and its say in the surface, is
  /// the first of kernel/2ⁿ, …, kernel/2, kernel (none below `least_kernel_m`) with enough of them:
  /// as fine as the points are dense. None is less than two cells.
  double kernel_m = 0.8, least_kernel_m = 0.2;
  int min_neighbours = 4;  ///< Points with fewer (after thinning, itself included) are left out.
  /// The surface ends where the weighted mean of the points lies farther off than this, in radii:
  /// 0.24 is the edge of a half plane, 0 on a closed surface.
  double border = 0.3;
  double noise_m = 0;  ///< σ of the simulated range; 0 = as the points lie about the surface.
  /// Leave out triangles that more beams passed than ended at. Off: an opaque mesh over all points.
  bool carve = false;
};

/// Part of the horizontal plane, m; contains its lower edges, not its upper ones.
struct Area {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// The surface over one tile, and how well it explains the tile's points.
struct SurfaceTile {
  IsoMesh mesh;
  double sum_squares_m2 = 0;  ///< Of the points' distances to the surface; add up over tiles:
  size_t points = 0;  ///< σ² = Σ sum_squares / Σ points. Points far from all surface not counted.
};

/// How far beyond a tile's area its points must reach so that neighbouring tiles join, m.
double surface_margin_m(const SurfaceOptions& options);

/// The surface over the cells whose lower corner (a multiple of `cell_m`) lies in `core`.
///
/// Points are thinned to at most one mean for each half cell, so that near and far ground weigh the
/// same; normals are those of a plane through the neighbours, turned towards `to_sensor`; the zero
/// surface of `distance` is cut by marching cubes and trimmed at the border of the points: holes
/// where there are no data, no rims around thin things [adamson04].
///
/// `points` (m) and `to_sensor` (unit vectors, or any vectors towards the sensor) are those of the
/// tile with its margin, in any order. Tiles whose areas abut join without cracks: their vertices
/// on the common edge are the same to the bit. Points that are not finite are left out. Throws
/// `std::invalid_argument` for lengths that differ, parameters that are not positive, a core that
/// is not finite, or cells so small for the kernel or the height that memory would not do (2²⁷).
SurfaceTile surface_tile(std::span<const Vec3f> points, std::span<const Vec3f> to_sensor,
                         const Area& core, const SurfaceOptions& options = {},
                         const SignedDistance& distance = imls);

}  // namespace underbrush::fit
