#pragma once
#include "underbrush/primitives/placed_object.hpp"

namespace underbrush::primitives {

/// Layers of points that all lie at one place.
inline PointLayers layers_at(const Vec3& place) {
  PointLayers out;
  out.z.fill(place.z());
  for (auto& places : out.x) places.fill(place.x());
  for (auto& places : out.y) places.fill(place.y());
  return out;
}

}  // namespace underbrush::primitives
