#include "underbrush/metrics/nearest.hpp"

#include <cmath>
#include <nanoflann.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::metrics {
namespace {

struct Cloud {
  std::span<const Vec3f> points;
  size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(size_t i, size_t d) const { return points[i][Eigen::Index(d)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud,
                                                 3, uint32_t>;

}  // namespace

Nearest nearest(std::span<const Vec3f> queries, std::span<const Vec3f> cloud) {
  require(!cloud.empty(), "nearest: the cloud is empty");
  const Cloud adaptor{cloud};
  const Tree tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(12));
  Nearest out;
  out.distance_m.resize(queries.size());
  out.index.resize(queries.size());
  parallel_for(queries.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      uint32_t index = 0;
      float squared = 0;
      tree.knnSearch(queries[i].data(), 1, &index, &squared);
      out.index[i] = index;
      out.distance_m[i] = std::sqrt(squared);
    }
  });
  return out;
}

}  // namespace underbrush::metrics
