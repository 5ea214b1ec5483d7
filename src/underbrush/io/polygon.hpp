/// \file
/// Polygons cut into triangles.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::io {

/// Cuts a polygon into n − 2 triangles of indices into its corners, in the polygon's sense of
/// rotation. A convex polygon becomes a fan from its first corner. Another one is seen along its
/// normal (Newell's) and its ears are clipped [meisters75]. A polygon that crosses itself, and one
/// of more than 1024 corners, become fans where no ear is left to clip.
std::vector<std::array<uint32_t, 3>> triangles_of_polygon(std::span<const Vec3> corners);

}  // namespace underbrush::io
