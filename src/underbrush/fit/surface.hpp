/// \file
/// An opaque surface through all points of a log: the everyday baseline `surface`, and the frame
/// into which other implicit surfaces fit.
#pragma once
#include <functional>
#include <span>

#include "underbrush/fit/marching_cubes.hpp"

namespace underbrush::fit {

/// A point of the surface with the unit normal of its neighbourhood, towards the sensor.
struct OrientedPoint {
  Vec3f position = Vec3f::Zero();  ///< m.
  Vec3f normal = Vec3f::Zero();
};

/// Signed distance (m, positive on the sensor's side) of `x` to the surface of the points `near`,
/// which are all those within `support_m` of it; NaN where there is none.
using SignedDistance =
    std::function<float(const Vec3f& x, std::span<const OrientedPoint> near, float support_m)>;

/// The implicit moving least squares surface: f(x) = Σ w_i n_i·(x − p_i) / Σ w_i with
/// w = (1 − |x − p|²/support²)⁴ (the weight of [oztireli09], whose robust version starts from
/// this).
float imls(const Vec3f& x, std::span<const OrientedPoint> near, float support_m);

/// Parameters of `surface_tile`; the defaults are those of [deschaud12] §V for a mobile log (for a
/// standing scanner: cell 0.01 m, kernel 0.04 m).
struct SurfaceOptions {
  double cell_m = 0.3;     ///< Cell of the marching cubes.
  double kernel_m = 0.4;   ///< Neighbourhood of a normal; no surface is farther from a point.
  int min_neighbours = 4;  ///< Points with fewer (after thinning, itself included) are left out.
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
/// same; normals are those of a plane through the neighbours within `kernel_m`, turned towards
/// `to_sensor`; the zero surface of `distance` is cut by marching cubes, and what lies farther than
/// `kernel_m` from every point is left out: holes where there are no data.
///
/// `points` (m) and `to_sensor` (unit vectors, or any vectors towards the sensor) are those of the
/// tile with its margin, in any order. Tiles whose areas abut join without cracks: their vertices
/// on the common edge are the same to the bit. Points that are not finite are left out. Throws
/// `std::invalid_argument` for lengths that differ, parameters that are not positive, a core that
/// is not finite, or a tile (its height included) of more than 2²⁷ cells.
SurfaceTile surface_tile(std::span<const Vec3f> points, std::span<const Vec3f> to_sensor,
                         const Area& core, const SurfaceOptions& options = {},
                         const SignedDistance& distance = imls);

}  // namespace underbrush::fit
