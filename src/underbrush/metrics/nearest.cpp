#include "underbrush/metrics/nearest.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/kd_tree.inl"
#include "underbrush/core/parallel.hpp"

namespace underbrush::metrics {

Nearest nearest(std::span<const Vec3f> queries, std::span<const Vec3f> cloud,
                const std::function<void(size_t)>& progress) {
  constexpr size_t kBlock = 4096, kAhead = 256;
  require(!cloud.empty(), "nearest: the cloud is empty");
  const CloudTree tree(cloud);
  Nearest out;
  out.distance_m.resize(queries.size());
  out.index.resize(queries.size());
  const auto search = [&](size_t block) {
    const size_t end = std::min(queries.size(), (block + 1) * kBlock);
    for (size_t i = block * kBlock; i < end; ++i) {
      float squared = 0;
      tree.nearest(queries[i].data(), 1, &out.index[i], &squared);
      out.distance_m[i] = std::sqrt(squared);
    }
  };
  parallel_in_order((queries.size() + kBlock - 1) / kBlock, kAhead, search, [&](size_t block) {
    if (progress) progress(block * kBlock);
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
