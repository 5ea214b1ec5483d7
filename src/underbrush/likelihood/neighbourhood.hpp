/// \file
/// This file has the shapes of the neighbourhoods of ellipsoids: flat on a wall, long along a
/// trunk, round in a crown.
#pragma once
#include <span>
#include <vector>

#include "underbrush/elements/model.hpp"

namespace underbrush::likelihood {

/// The number of ellipsoids of a neighbourhood.
inline constexpr size_t kNeighbourhood = 7;

/// Computes the shape Σ₀ (m²) of the neighbourhood of each ellipsoid. With the `kNeighbourhood`
/// ellipsoids (μ_j, Σ_j) of the nearest means, itself among them, it is
///
///     Σ₀ ∝ Σ_j Σ_j + (μ_j − μ)(μ_j − μ)ᵀ,
///
/// with the trace of the ellipsoid's own covariance. Ellipsoids of a few points each thus know what
/// all points around say of the direction in which they are flat. The result has the same bits for
/// any number of threads.
std::vector<Mat3> neighbourhood_shapes(std::span<const elements::Ellipsoid> ellipsoids);

}  // namespace underbrush::likelihood
