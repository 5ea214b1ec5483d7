// Generated scenes for the tracing benchmark: a wavy ground with trees or grass of ellipsoids.
// Synthetic data.
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/core/ray.hpp"
#include "underbrush/elements/scene.hpp"

namespace underbrush::bench {

/// Height of the ground (m).
double ground_z(double x, double y);

/// A square of ground `side_m` wide around the origin, triangles with legs of `cell_m`.
elements::TriangleMesh ground_mesh(double side_m, double cell_m);

/// Ground of 100 m × 100 m in 320 000 triangles, and `ellipsoids` in trees (a corridor along y = 0
/// is free, where the sensor drives).
elements::Model forest(size_t ellipsoids);

/// The same ground with tussocks of grass everywhere.
elements::Model field(size_t ellipsoids);

/// Trees of a few thousand ellipsoids each, 16 kinds, placed `instances` times on a ground as wide
/// as they need; no further than 500 m of it in triangles of 0.25 m.
elements::Scene planted(size_t instances);

/// One opaque triangle for each ellipsoid, of the area that stops as many beams, and the ground.
elements::TriangleMesh as_triangles(const elements::Model& model);

/// Rays of a sensor that drives along y = 0 at 10 m/s, 2 m above the ground, in firing order;
/// `sub_rays` over a cone of 3 mrad for each beam, one after another.
std::vector<Ray> drive(const char* sensor, int revolutions, int sub_rays);

}  // namespace underbrush::bench
