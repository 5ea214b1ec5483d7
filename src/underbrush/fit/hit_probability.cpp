#include "underbrush/fit/hit_probability.hpp"

#include <atomic>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::fit {
namespace {

float probability(uint32_t hits, uint32_t misses, const HitPrior& prior) {
  const double n = double(hits) + misses + prior.a + prior.b;
  return n > 0 ? float((hits + prior.a) / n) : 1.0f;
}

void add_one(uint32_t& counter) {
  std::atomic_ref<uint32_t>(counter).fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

Credit credit(const elements::Model& model, std::span<const trace::Met> met, double range_m,
              const CreditOptions& options) {
  if (range_m == kMiss) return {met.size(), met.size()};
  size_t before = 0;
  for (size_t k = 0; k < met.size(); ++k) {
    const trace::Met& m = met[k];
    const double residual = range_m - m.t_m;
    bool explains;
    if (model.kind(m.element) == elements::Kind::kEllipsoid) {
      const double s = residual / m.sigma_m;
      explains = m.delta2 + s * s < model.tau * model.tau;
    } else {
      explains = std::abs(residual) < options.max_residual_for_hit_m;
    }
    if (explains) return {k, k};
    if (m.t_m < range_m) before = k + 1;
  }
  return {met.size(), before};
}

void count_hits(elements::Model& model, BeamSource& source, const CreditOptions& options,
                const std::function<void(size_t, size_t)>& progress) {
  for (const HitPrior& prior : {options.ellipsoid, options.triangle}) {
    require(prior.a >= 0 && prior.b >= 0, "a prior count must not be negative");
  }
  for (size_t i = 0; i < model.size(); ++i) model.hit(i) = {1, 0, 0};
  const trace::World world(model);
  const LogInfo& info = source.info();
  source.rewind();
  BeamLog chunk;
  size_t done = 0;
  while (source.next(chunk)) {
    const trace::RangeLimits limits{info.min_range_m,
                                    std::min(info.max_range_m, model.max_range_m)};
    parallel_for(chunk.size(), 2048, [&](size_t begin, size_t end) {
      std::vector<Ray> rays;
      std::vector<double> reach;
      for (size_t i = begin; i < end; ++i) {
        rays.push_back({chunk.origin[i], chunk.direction[i].cast<double>().normalized()});
        // An element that contains the point has its bounds entered before the point.
        reach.push_back(std::min(double(chunk.range_m[i]), limits.max_m));
      }
      trace::MetLists met;
      world.all_met(rays, limits, reach, met);
      for (size_t i = begin; i < end; ++i) {
        const auto list = met[i - begin];
        const Credit c = credit(model, list, chunk.range_m[i], options);
        for (size_t k = 0; k < c.misses; ++k) add_one(model.hit(list[k].element).misses);
        if (c.hit < list.size()) add_one(model.hit(list[c.hit].element).hits);
      }
    });
    done += chunk.size();
    if (progress) progress(done, source.size());
  }
  for (size_t i = 0; i < model.size(); ++i) {
    elements::HitCount& h = model.hit(i);
    const bool ellipsoid = model.kind(i) == elements::Kind::kEllipsoid;
    h.p = probability(h.hits, h.misses, ellipsoid ? options.ellipsoid : options.triangle);
  }
}

}  // namespace underbrush::fit
