#include "underbrush/simulate/footprint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
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

/// The sub-rays of beams of one shape.
class SubRays {
 public:
  explicit SubRays(const FootprintOptions& options)
      : options_(options),
        maker_(options.shape),
        places_(sensor::spread_sub_rays(options.shape, options.sub_rays)) {}

  /// Appends those of a beam, rotated at random about its axis, to `rays`.
  void append(Ray axis, uint64_t key, std::vector<Ray>& rays) const {
    const double turn = 2 * M_PI * uniform_from_bits(random_bits(key, 0, Purpose::kDirection));
    const double encoder_step_rad = options_.shape.encoder_step_rad;
    if (encoder_step_rad > 0) {
      const double off = uniform_from_bits(random_bits(key, 1, Purpose::kDirection)) - 0.5;
      axis.direction = Eigen::AngleAxisd(off * encoder_step_rad, Vec3::UnitZ()) * axis.direction;
    }
    const sensor::BeamAxes axes = sensor::beam_axes(axis);
    const double c = std::cos(turn), s = std::sin(turn);
    for (const auto& [u, v, weight] : places_) {
      rays.push_back(maker_.ray(axes, c * u - s * v, s * u + c * v));
    }
  }

 private:
  const FootprintOptions& options_;
  sensor::RayMaker maker_;
  std::vector<sensor::SubRay> places_;
};

/// What a receiver reports of a beam.
struct Echo {
  double range_m = kMiss;  ///< Without noise.
  double share = 0;        ///< The share of the sub-rays in it.
  uint32_t element = Intersection::kNone;
};

/// Finds the strongest echo of the surfaces that the sub-rays of a beam met.
Echo reported_echo(std::span<const Intersection> met, const FootprintOptions& options,
                   std::vector<Intersection>& hits) {
  hits.clear();
  std::copy_if(met.begin(), met.end(), std::back_inserter(hits),
               [](const Intersection& m) { return !m.none(); });
  std::sort(hits.begin(), hits.end(),
            [](const Intersection& a, const Intersection& b) { return a.before(b); });
  const auto [from, to] = strongest_echo(hits, options.pulse_m);
  if (to == from || double(to - from) < options.threshold * options.sub_rays) return {};
  Echo out{0, double(to - from) / options.sub_rays, hits[from].element};
  for (size_t k = from; k < to; ++k) out.range_m += hits[k].t_m / double(to - from);
  return out;
}

}  // namespace

void scan(const trace::World& world, std::span<const elements::Class> label,
          const FootprintOptions& options, size_t first_beam, BeamLog& beams) {
  options.shape.check();
  require(label.size() == world.model().size(), "one label per element of the world is needed");
  const SubRays sub_rays(options);
  const trace::RangeLimits limits{std::max(beams.info.min_range_m, kLeastRangeM),
                                  beams.info.max_range_m};
  std::vector<uint16_t> classes(beams.size());
  std::vector<uint32_t> element(options.element_ids ? beams.size() : 0, Intersection::kNone);
  parallel_for(beams.size(), 1024, [&](size_t begin, size_t end) {
    const auto key_of = [&](size_t i) {
      return beam_key(options.seed, beams.scan[i], first_beam + i);
    };
    std::vector<Ray> rays;
    rays.reserve((end - begin) * size_t(options.sub_rays));
    for (size_t i = begin; i < end; ++i) sub_rays.append(beams.ray(i), key_of(i), rays);
    std::vector<Intersection> met(rays.size()), hits;
    world.nearest_surface(rays, limits, met);
    const size_t n = rays.size() / (end - begin);
    for (size_t i = begin; i < end; ++i) {
      const Echo echo = reported_echo(std::span(met).subspan((i - begin) * n, n), options, hits);
      beams.range_m[i] = kMiss;
      beams.intensity[i] = float(echo.share);
      if (echo.element == Intersection::kNone) continue;
      const double noise_m = options.range_sigma_m * normal(key_of(i), 0, Purpose::kNoise);
      beams.range_m[i] = float(std::clamp(echo.range_m + noise_m, limits.min_m, limits.max_m));
      classes[i] = uint16_t(label[echo.element]);
      if (options.element_ids) element[i] = echo.element;
    }
  });
  beams.extra["class"] = std::move(classes);
  if (options.element_ids) beams.extra["element"] = std::move(element);
}

}  // namespace underbrush::simulate
