#include "underbrush/metrics/nearest.hpp"

#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/kd_tree.inl"
#include "underbrush/core/parallel.hpp"

namespace underbrush::metrics {

Nearest nearest(std::span<const Vec3f> queries, std::span<const Vec3f> cloud) {
  require(!cloud.empty(), "nearest: the cloud is empty");
  const CloudTree tree(cloud);
  Nearest out;
  out.distance_m.resize(queries.size());
  out.index.resize(queries.size());
  parallel_for(queries.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      uint32_t index = 0;
      float squared = 0;
      tree.nearest(queries[i].data(), 1, &index, &squared);
      out.index[i] = index;
      out.distance_m[i] = std::sqrt(squared);
    }
  });
  return out;
}

std::vector<double> chamfer_terms(const Nearest& nearest, size_t cloud_size) {
  constexpr double kAlpha = 10;  // 1/m
  std::vector<uint32_t> shared(cloud_size);
  for (const uint32_t k : nearest.index) ++shared[k];
  std::vector<double> out(nearest.index.size());
  for (size_t i = 0; i < out.size(); ++i) {
    const double d = nearest.distance_m[i];
    out[i] = 1 - std::exp(-kAlpha * d) / double(shared[nearest.index[i]]);
  }
  return out;
}

}  // namespace underbrush::metrics
