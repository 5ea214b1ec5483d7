#include "underbrush/likelihood/neighbourhood.hpp"

#include <array>

#include "underbrush/core/kd_tree.inl"
#include "underbrush/core/parallel.hpp"

namespace underbrush::likelihood {

std::vector<Neighbourhood> neighbourhoods(std::span<const elements::Ellipsoid> ellipsoids,
                                          std::span<const Evidence> evidence) {
  std::vector<Neighbourhood> out(ellipsoids.size());
  const KdTree tree(
      ellipsoids.size(),
      [&](size_t i, size_t axis) { return ellipsoids[i].mean[Eigen::Index(axis)]; }, 12);
  parallel_for(ellipsoids.size(), 1024, [&](size_t begin, size_t end) {
    std::array<uint32_t, kNeighbourhood> near;
    std::array<float, kNeighbourhood> squared;
    for (size_t i = begin; i < end; ++i) {
      const elements::Ellipsoid& e = ellipsoids[i];
      const size_t found = tree.nearest(e.mean.data(), near.size(), near.data(), squared.data());
      Mat3 sum = Mat3::Zero();
      Evidence all;
      for (size_t k = 0; k < found; ++k) {
        const elements::Ellipsoid& other = ellipsoids[near[k]];
        const Vec3 apart = (other.mean - e.mean).cast<double>();
        sum += other.covariance_matrix() + apart * apart.transpose();
        all.hits += evidence[near[k]].hits;
        all.path_m += evidence[near[k]].path_m;
      }
      out[i].shape = sum * (e.covariance_matrix().trace() / sum.trace());
      if (all.path_m > 0) out[i].density_per_m = all.hits / all.path_m;
    }
  });
  return out;
}

}  // namespace underbrush::likelihood
