/// \file
/// Nearest neighbours between two clouds.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::metrics {

/// For each query point, its nearest point of a cloud and how far it is.
struct Nearest {
  std::vector<float> distance_m;
  std::vector<uint32_t> index;
};

/// Exact; ties by the search's order. `cloud` must not be empty. One frame, metres.
Nearest nearest(std::span<const Vec3f> queries, std::span<const Vec3f> cloud);

}  // namespace underbrush::metrics
