#include "underbrush/credit/explaining.hpp"

#include <algorithm>

#include "underbrush/core/parallel.hpp"
#include "underbrush/credit/hit_probability.hpp"

namespace underbrush::credit {

std::vector<uint32_t> explaining_elements(const trace::World& world, const BeamLog& log) {
  const elements::Model& model = world.model();
  CreditOptions options;
  options.rule = "best";
  const trace::RangeLimits limits{log.info.min_range_m,
                                  std::min(log.info.max_range_m, model.max_range_m)};
  std::vector<uint32_t> found(log.size(), trace::Intersection::kNone);
  parallel_for(log.size(), 2048, [&](size_t begin, size_t end) {
    std::vector<size_t> hits;
    std::vector<Ray> rays;
    std::vector<double> reach;
    for (size_t i = begin; i < end; ++i) {
      if (!log.is_hit(i)) continue;
      hits.push_back(i);
      rays.push_back(log.ray(i));
      reach.push_back(
          std::min(double(log.range_m[i]) + options.max_residual_for_hit_m, limits.max_m));
    }
    trace::IntersectionLists met;
    world.all_intersections(rays, limits, reach, met, trace::World::Sequence::kAny);
    std::vector<Credit> said;
    for (size_t h = 0; h < hits.size(); ++h) {
      credit(model, met[h], log.range_m[hits[h]], options, said);
      const auto hit = std::find(said.begin(), said.end(), Credit::kHit);
      if (hit != said.end()) found[hits[h]] = met[h][size_t(hit - said.begin())].element;
    }
  });
  return found;
}

}  // namespace underbrush::credit
