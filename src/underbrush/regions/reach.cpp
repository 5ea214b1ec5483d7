#include "underbrush/regions/reach.hpp"

#include <algorithm>

namespace underbrush::regions {
namespace {

using Box = Eigen::AlignedBox3d;

/// Whether the segment of a ray from its origin to a range (m) meets a box.
bool meets(const Ray& ray, double range_m, const Box& box) {
  double from = 0, to = range_m;
  for (int k = 0; k < 3; ++k) {
    const double o = ray.origin[k], d = ray.direction[k];
    if (d == 0) {
      if (o < box.min()[k] || o > box.max()[k]) return false;
      continue;
    }
    const double a = (box.min()[k] - o) / d, b = (box.max()[k] - o) / d;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return from <= to;
}

}  // namespace

std::vector<uint32_t> reached(const Index& index, const BeamLog& beams, size_t begin, size_t end,
                              double range_m, double spread_m) {
  Box all;
  for (size_t i = begin; i < end; ++i) {
    all.extend(beams.origin[i]);
    all.extend(Vec3(beams.origin[i] + range_m * beams.ray(i).direction));
  }
  std::vector<uint32_t> found;
  std::vector<std::pair<uint32_t, Box>> open;  // those that no beam is known to meet
  for (uint32_t k = 0; k < index.regions.size(); ++k) {
    Box box = index.regions[k].bounds;
    box.min().array() -= spread_m;
    box.max().array() += spread_m;
    if (box.intersects(all)) open.emplace_back(k, box);
  }
  for (size_t i = begin; i < end && !open.empty(); ++i) {
    const Ray ray = beams.ray(i);
    std::erase_if(open, [&](const auto& region) {
      if (!meets(ray, range_m, region.second)) return false;
      found.push_back(region.first);
      return true;
    });
  }
  std::ranges::sort(found);
  return found;
}

}  // namespace underbrush::regions
