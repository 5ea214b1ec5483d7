/// \file
/// The triangles of a mesh that were there before it was made again.
#pragma once
#include <limits>
#include <vector>

#include "underbrush/elements/model.hpp"

namespace underbrush::update {

/// The number of a new triangle in the list of `kept_triangles`.
inline constexpr uint32_t kNewTriangle = std::numeric_limits<uint32_t>::max();

/// Finds for each triangle of `now` the triangle of `before` with the same corners, whose heights
/// differ by at most `most_rise_m` (m), or `kNewTriangle`. Corners are compared in the order of the
/// triangle, from any of them on.
std::vector<uint32_t> kept_triangles(const elements::TriangleMesh& before,
                                     const elements::TriangleMesh& now, float most_rise_m = 0.01f);

}  // namespace underbrush::update
