#include "underbrush/simulate/median.hpp"

#include <algorithm>
#include <cmath>

namespace underbrush::simulate {

std::vector<BeamAnswer> median_answers(const trace::World& world,
                                       const keyframes::KeyframeCache* cache,
                                       std::span<const Ray> rays, std::span<const uint16_t> rings,
                                       const trace::RangeLimits& limits) {
  trace::IntersectionLists met;
  world.all_intersections(rays, limits, std::vector<double>(rays.size(), limits.max_m), met);
  std::vector<keyframes::CachedPixels> pixels;
  if (cache) pixels = cache->look_up(cache->queries(rays, rings));
  std::vector<BeamAnswer> out(rays.size());
  trace::RangeMixture p;
  std::vector<trace::Intersection> merged;
  for (size_t k = 0; k < rays.size(); ++k) {
    const std::span<const trace::Intersection> all =
        world.with_unknown(rays[k], limits, met[k], merged);
    trace::mix_ranges(all, 1, 1e-4, p);
    const size_t elements = p.components.size();
    if (cache) cache->mix(pixels[k], p);
    const std::optional<double> range = p.median();
    if (!range) continue;
    BeamAnswer& answer = out[k];
    answer.range_m = std::clamp(*range, limits.min_m, limits.max_m);
    const size_t component = p.likeliest_at(*range);
    if (component < elements) {
      answer.met = all[component];
      continue;
    }
    const keyframes::CachedPixels& r = pixels[k];
    size_t pixel = 0;
    const auto off = [&](size_t j) { return std::abs(r.range_m[j] - *range); };
    for (size_t j = 1; j < r.count; ++j) pixel = off(j) < off(pixel) ? j : pixel;
    answer.cached = keyframes::KeyframeCache::return_of(r, pixel);
    answer.cached->range_m = answer.range_m;
  }
  return out;
}

}  // namespace underbrush::simulate
