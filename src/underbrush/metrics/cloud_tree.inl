// A k-d tree over a cloud. Only sources of this module include it, because it includes nanoflann.
#include <nanoflann.hpp>
#include <span>

#include "underbrush/core/pose.hpp"

namespace underbrush::metrics {

/// Presents points to nanoflann.
struct CloudPoints {
  std::span<const Vec3f> points;
  size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(size_t i, size_t d) const { return points[i][Eigen::Index(d)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using CloudTree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, CloudPoints>,
                                        CloudPoints, 3, uint32_t>;

}  // namespace underbrush::metrics
