/// \file
/// This file estimates the normals of a cloud from nearest neighbours.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::metrics {

/// Computes the normal of each point: the unit direction of least spread of its `k` nearest points,
/// itself among them, or of all points if there are fewer. Points that all coincide give (0, 0, 1).
/// The cloud is in metres and should be near its origin.
///
/// The sign does not distinguish inside from outside. It is that of Open3D's closed-form
/// eigenvectors, on which the figures of [goodin24] rest (docs/results/verification.md). Throws
/// `std::invalid_argument` for k < 3.
std::vector<Vec3f> normals(std::span<const Vec3f> cloud, size_t k);

}  // namespace underbrush::metrics
