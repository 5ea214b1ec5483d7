#include "underbrush/simulate/support.hpp"

#include <algorithm>

#include "underbrush/core/parallel.hpp"

namespace underbrush::simulate {

std::vector<float> supports(const trace::World& world, const BeamLog& beams) {
  std::vector<float> out(beams.size(), 1.0F);
  if (!world.unknown_space()) return out;
  const trace::RangeLimits limits{beams.info.min_range_m,
                                  std::min(beams.info.max_range_m, world.model(0).max_range_m)};
  parallel_for(beams.size(), 2048, [&](size_t begin, size_t end) {
    std::vector<Ray> rays;
    rays.reserve(end - begin);
    for (size_t i = begin; i < end; ++i) rays.push_back(beams.ray(i));
    trace::IntersectionLists met;
    world.all_intersections(rays, limits, std::vector<double>(rays.size(), limits.max_m), met);
    std::vector<trace::Intersection> merged;
    trace::RangeMixture p;
    for (size_t k = 0; k < rays.size(); ++k) {
      const auto all = world.with_unknown(rays[k], limits, met[k], merged);
      trace::mix_ranges(all, 1, 1e-4, p);
      out[begin + k] = float(trace::support_of(all, p));
    }
  });
  return out;
}

}  // namespace underbrush::simulate
