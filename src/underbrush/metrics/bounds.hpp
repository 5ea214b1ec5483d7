/// \file
/// The box in which a world lies.
#pragma once
#include <cmath>
#include <span>

#include "underbrush/elements/scene.hpp"

namespace underbrush::metrics {

/// A box with sides along the axes; empty until a point is added.
struct Bounds {
  Vec3 low = Vec3::Constant(INFINITY), high = Vec3::Constant(-INFINITY);  ///< m
  void add(const Vec3& x) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  bool empty() const { return !(low.x() <= high.x()); }
  /// Whether a box lies within.
  bool contains(const Bounds& box) const {
    return (low.array() <= box.low.array()).all() && (box.high.array() <= high.array()).all();
  }
};

/// The bounds of the vertices of a scene, and of its ellipsoids within two standard deviations.
/// Without instances the first model lies at its origin.
Bounds bounds_of(std::span<const elements::Model> models,
                 std::span<const elements::Instance> instances);
/// Adds the bounds of a scene to other bounds.
void add_bounds(std::span<const elements::Model> models,
                std::span<const elements::Instance> instances, Bounds& bounds);

}  // namespace underbrush::metrics
