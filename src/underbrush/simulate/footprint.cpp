#include "underbrush/simulate/footprint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::simulate {
namespace {

using trace::Intersection;

/// Finds the strongest group of hits that lie within a pulse of each other, as the range [begin,
/// end) of `hits`.
std::array<size_t, 2> strongest_echo(const std::vector<Intersection>& hits, double pulse_m) {
  std::array<size_t, 2> best{0, 0};
  for (size_t begin = 0; begin < hits.size();) {
    size_t end = begin + 1;
    while (end < hits.size() && hits[end].t_m - hits[end - 1].t_m < pulse_m) ++end;
    if (end - begin > best[1] - best[0]) best = {begin, end};
    begin = end;
  }
  return best;
}

}  // namespace

void scan(const trace::World& world, std::span<const elements::Class> label,
          const FootprintOptions& options, size_t first_beam, BeamLog& beams) {
  options.shape.check();
  const sensor::RayMaker maker(options.shape);
  const std::vector<sensor::SubRay> places =
      sensor::spread_sub_rays(options.shape, options.sub_rays);
  require(label.size() == world.model().size(), "one label per element of the world is needed");
  const trace::RangeLimits limits{std::max(beams.info.min_range_m, kLeastRangeM),
                                  beams.info.max_range_m};
  std::vector<uint16_t> classes(beams.size());
  std::vector<uint32_t> element(options.element_ids ? beams.size() : 0, Intersection::kNone);
  parallel_for(beams.size(), 1024, [&](size_t begin, size_t end) {
    std::vector<Intersection> hits;
    for (size_t i = begin; i < end; ++i) {
      Ray axis = beams.ray(i);
      const uint64_t key = beam_key(options.seed, beams.scan[i], first_beam + i);
      const double turn = 2 * M_PI * uniform_from_bits(random_bits(key, 0, Purpose::kDirection));
      if (options.shape.encoder_step_rad > 0) {
        const double off = uniform_from_bits(random_bits(key, 1, Purpose::kDirection)) - 0.5;
        axis.direction =
            Eigen::AngleAxisd(off * options.shape.encoder_step_rad, Vec3::UnitZ()) * axis.direction;
      }
      const sensor::BeamAxes axes = sensor::beam_axes(axis);
      const double c = std::cos(turn), s = std::sin(turn);
      hits.clear();
      for (const auto& [u, v, weight] : places) {
        const Ray ray = maker.ray(axes, c * u - s * v, s * u + c * v);
        const Intersection met = world.nearest_surface(ray, limits);
        if (!met.none()) hits.push_back(met);
      }
      std::sort(hits.begin(), hits.end(),
                [](const Intersection& a, const Intersection& b) { return a.before(b); });
      const auto [from, to] = strongest_echo(hits, options.pulse_m);
      beams.range_m[i] = kMiss;
      beams.intensity[i] = 0;
      if (to == from || double(to - from) < options.threshold * options.sub_rays) continue;
      double range = options.range_sigma_m * normal(key, 0, Purpose::kNoise);
      for (size_t k = from; k < to; ++k) range += hits[k].t_m / double(to - from);
      beams.range_m[i] = float(std::clamp(range, limits.min_m, limits.max_m));
      beams.intensity[i] = float(to - from) / float(options.sub_rays);
      classes[i] = uint16_t(label[hits[from].element]);
      if (options.element_ids) element[i] = hits[from].element;
    }
  });
  beams.extra["class"] = std::move(classes);
  if (options.element_ids) beams.extra["element"] = std::move(element);
}

}  // namespace underbrush::simulate
