/// \file
/// Normals of a cloud from its nearest neighbours.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::metrics {

/// For each point the unit direction of least spread of its `k` nearest points, itself among them
/// (all points if there are fewer). The sign says nothing of inside and outside: it is that of
/// Open3D's closed-form eigenvectors, on which [goodin24] rests (docs/explanation/validation.md);
/// points that all coincide give (0, 0, 1). One frame, m; keep the cloud near its origin. Throws
/// `std::invalid_argument` for k < 3.
std::vector<Vec3f> normals(std::span<const Vec3f> cloud, size_t k);

}  // namespace underbrush::metrics
