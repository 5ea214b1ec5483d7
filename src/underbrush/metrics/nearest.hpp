/// \file
/// This file finds nearest neighbours between two clouds.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::metrics {

/// For each query point, the index of its nearest point in a cloud and the distance to it.
struct Nearest {
  std::vector<float> distance_m;
  std::vector<uint32_t> index;
};

/// Finds nearest neighbours exactly; among equally near points the search's order decides. Both
/// clouds are in one frame, m; `cloud` must not be empty. `progress(done)` may be empty.
Nearest nearest(std::span<const Vec3f> queries, std::span<const Vec3f> cloud,
                const std::function<void(size_t)>& progress = {});

/// Computes 1 − e^{−α d}/n of each query, with α = 10/m, where n queries share their nearest point.
/// The density-aware Chamfer distance (Wu et al. 2021) is the mean of these terms over both
/// directions. `cloud_size` is the number of points of the cloud.
std::vector<double> chamfer_terms(const Nearest& nearest, size_t cloud_size);

}  // namespace underbrush::metrics
