// Generated scenes for the tracing benchmark: a wavy ground with trees or grass of ellipsoids. The
// data are synthetic.
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/core/ray.hpp"
#include "underbrush/elements/scene.hpp"

namespace underbrush::bench {

/// Returns the height of the ground (m).
double ground_z(double x, double y);

/// Returns a square of ground `side_m` wide around the origin, in triangles with legs of `cell_m`.
elements::TriangleMesh ground_mesh(double side_m, double cell_m);

/// Returns 100 m × 100 m of ground in 320 000 triangles, with `ellipsoids` in trees; a corridor
/// along y = 0 is free for the sensor to drive in.
elements::Model forest(size_t ellipsoids);

/// Returns the ground of `forest` with tussocks of grass everywhere.
elements::Model field(size_t ellipsoids);

/// Returns a scene of trees with a few thousand ellipsoids each, of 16 kinds, placed `instances`
/// times on a ground as wide as they need. At most 500 m of it are in triangles of 0.25 m.
elements::Scene planted(size_t instances);

/// Returns the ground and, for each ellipsoid, an opaque triangle of the area that stops as many
/// beams.
elements::TriangleMesh as_triangles(const elements::Model& model);

/// Returns the rays of a sensor that drives along y = 0 at 10 m/s, 2 m above the ground, in firing
/// order. The `sub_rays` rays of a beam cover a cone of 3 mrad and follow each other.
std::vector<Ray> drive(const char* sensor, int revolutions, int sub_rays);

}  // namespace underbrush::bench
