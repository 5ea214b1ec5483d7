#include "underbrush/likelihood/neighbourhood.hpp"

#include <algorithm>

#include "underbrush/core/kd_tree.inl"
#include "underbrush/core/parallel.hpp"

namespace underbrush::likelihood {

Neighbours::Neighbours(std::span<const elements::Ellipsoid> ellipsoids)
    : near_(ellipsoids.size()), count_(std::min(kNeighbourhood, ellipsoids.size())) {
  const KdTree tree(
      ellipsoids.size(),
      [&](size_t i, size_t axis) { return ellipsoids[i].mean[Eigen::Index(axis)]; }, 12);
  parallel_for(ellipsoids.size(), 1024, [&](size_t begin, size_t end) {
    std::array<float, kNeighbourhood> squared;
    for (size_t i = begin; i < end; ++i) {
      tree.nearest(ellipsoids[i].mean.data(), count_, near_[i].data(), squared.data());
    }
  });
}

std::vector<Neighbourhood> Neighbours::neighbourhoods(
    std::span<const elements::Ellipsoid> ellipsoids, std::span<const Evidence> evidence) const {
  std::vector<Neighbourhood> out(ellipsoids.size());
  parallel_for(ellipsoids.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const elements::Ellipsoid& e = ellipsoids[i];
      Mat3 sum = Mat3::Zero();
      Evidence all;
      for (size_t k = 0; k < count_; ++k) {
        const uint32_t near = near_[i][k];
        const elements::Ellipsoid& other = ellipsoids[near];
        const Vec3 apart = (other.mean - e.mean).cast<double>();
        sum += other.covariance_matrix() + apart * apart.transpose();
        all.hits += evidence[near].hits;
        all.path_m += evidence[near].path_m;
      }
      out[i].shape = sum * (e.covariance_matrix().trace() / sum.trace());
      if (all.path_m > 0) out[i].density_per_m = all.hits / all.path_m;
    }
  });
  return out;
}

}  // namespace underbrush::likelihood
