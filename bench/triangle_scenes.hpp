// Generated worlds of opaque triangles for the benchmark of triangles. The data are synthetic.
#pragma once
#include <string>

#include "underbrush/elements/model.hpp"

namespace underbrush::bench {

/// The names of the worlds.
inline constexpr const char* kTriangleWorlds[] = {"leaves", "plants", "terrain"};

/// Returns a world of 100 m × 100 m in about `triangles` triangles, with a corridor along y = 0
/// for the sensor to drive in:
/// - `leaves`: a forest as surveys of HELIOS++ have it. Trees have stems and branches of thin tubes
///   and 5 000 flat leaves of 4 to 9 cm, each of two triangles, and the ground is coarse.
/// - `plants`: trees, shrubs and tussocks of the generated test site.
/// - `terrain`: the ground alone.
elements::Model triangle_world(const std::string& name, size_t triangles);

}  // namespace underbrush::bench
