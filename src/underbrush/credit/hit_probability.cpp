#include "underbrush/credit/hit_probability.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::credit {
namespace {

void add_one(uint32_t& counter) {
  std::atomic_ref<uint32_t>(counter).fetch_add(1, std::memory_order_relaxed);
}

void check(const CreditOptions& options) {
  const auto rules = credit_rules();
  require(std::find(rules.begin(), rules.end(), options.rule) != rules.end(),
          "the rules of credit are first, best and mahalanobis");
  for (const HitPrior& prior : {options.ellipsoid, options.triangle}) {
    require(prior.a >= 0 && prior.b >= 0, "a prior count must not be negative");
  }
}

Trials trials_of(const elements::HitCount& h) { return {h.hits, h.misses}; }

double sigma_of(const trace::Intersection& m) {
  constexpr double kLeastSigmaM = 1e-6;  // a mesh may say 0
  return std::max(m.sigma_m, kLeastSigmaM);
}

/// Whether an element explains a measured range.
bool explains(const elements::Model& model, const trace::Intersection& m, double range_m,
              double tau, const CreditOptions& options) {
  const double residual = range_m - m.t_m, s = residual / sigma_of(m);
  return model.kind(m.element) == elements::Kind::kEllipsoid
             ? m.delta2 + s * s < tau * tau
             : std::abs(residual) < options.max_residual_for_hit_m;
}

/// Computes log N(z; t, σ²) of a measured range, up to a constant.
double log_density(const trace::Intersection& m, double range_m) {
  const double s = (range_m - m.t_m) / sigma_of(m);
  return -0.5 * s * s - std::log(sigma_of(m));
}

/// Credits a beam that something moving has stopped: it passed all elements before that.
void credit_passes(std::span<const trace::Intersection> met, double range_m,
                   const CreditOptions& options, std::vector<Credit>& out) {
  out.assign(met.size(), Credit::kNothing);
  for (size_t k = 0; k < met.size(); ++k) {
    const bool is_before = met[k].t_m < range_m - options.max_residual_for_hit_m;
    if (is_before) out[k] = Credit::kMiss;
  }
}

void add_residual(const elements::Model& model, const trace::Intersection& hit,
                  const Vec3& direction, double range_m, CreditedResiduals& residuals) {
  const elements::ElementPlace place = model.place(hit.element);
  if (place.kind == elements::Kind::kEllipsoid) return;
  const bool is_ground = place.kind == elements::Kind::kGround;
  MeshResiduals& of = is_ground ? residuals.ground : residuals.surface;
  of.add(is_ground ? model.ground : model.surface, place.index, direction, range_m - hit.t_m);
}

}  // namespace

std::vector<std::string_view> credit_rules() { return {"first", "best", "mahalanobis"}; }

void credit(const elements::Model& model, std::span<const trace::Intersection> met, double range_m,
            const CreditOptions& options, std::vector<Credit>& out) {
  out.assign(met.size(), range_m == kMiss ? Credit::kMiss : Credit::kNothing);
  const bool alone = options.rule != "mahalanobis";  // one beam gives at most one hit
  const double tau = model.tau;
  const bool nearest = options.rule == "first";
  size_t stopped = met.size();  // the entry of the element that gets the only hit
  double best = -INFINITY;
  for (size_t k = 0; k < met.size(); ++k) {
    const trace::Intersection& m = met[k];
    if (m.delta2 > tau * tau) {
      out[k] = Credit::kNothing;
      continue;
    }
    if (range_m == kMiss) continue;
    const bool is_nearer = stopped == met.size() || m.before(met[stopped]);
    if (nearest && !is_nearer) continue;
    if (!explains(model, m, range_m, tau, options)) {
      if (range_m > m.t_m) out[k] = Credit::kMiss;
    } else if (!alone) {
      out[k] = Credit::kHit;
    } else if (nearest) {
      stopped = k;
    } else if (const double density = log_density(m, range_m);
               density > best || (density == best && is_nearer)) {
      best = density;
      stopped = k;
    }
  }
  if (stopped == met.size()) return;
  // Elements before the hit can have their closest approach beyond the measured range. They get a
  // miss, because the beam passed them on its way to the element that stopped it.
  for (size_t k = 0; k < met.size(); ++k) {
    if (met[k].delta2 > tau * tau) continue;
    out[k] = k == stopped                  ? Credit::kHit
             : met[k].before(met[stopped]) ? Credit::kMiss
                                           : Credit::kNothing;
  }
}

Tally::Tally(const elements::Model& model, const CreditOptions& options)
    : of(model.size()),
      times(model.ellipsoids.size()),
      residuals{MeshResiduals(options.max_residual_for_hit_m),
                MeshResiduals(options.max_residual_for_hit_m)} {
  check(options);
}

void Tally::add(const trace::World& world, BeamSource& source, const CreditOptions& options,
                const std::function<void(size_t, size_t)>& progress) {
  const elements::Model& model = world.model();
  const LogInfo& info = source.info();
  source.rewind();
  BeamLog chunk;
  size_t done = 0;
  const size_t meshes = model.triangle_count();
  while (source.next(chunk)) {
    if (!zero_s && !chunk.empty()) zero_s = chunk.time_s.front();
    const trace::RangeLimits limits{info.min_range_m,
                                    std::min(info.max_range_m, model.max_range_m)};
    parallel_for(chunk.size(), 2048, [&](size_t begin, size_t end) {
      std::vector<Ray> rays;
      std::vector<double> reach;
      for (size_t i = begin; i < end; ++i) {
        rays.push_back(chunk.ray(i));
        // The tracer lists an element if the ray enters its bounds before the reach. For an
        // ellipsoid that holds the point this is so at the point, for a triangle within the largest
        // residual.
        reach.push_back(
            std::min(double(chunk.range_m[i]) + options.max_residual_for_hit_m, limits.max_m));
      }
      trace::IntersectionLists met;
      world.all_intersections(rays, limits, reach, met, trace::World::Sequence::kAny);
      std::vector<Credit> said;
      for (size_t i = begin; i < end; ++i) {
        const std::span<const trace::Intersection> list = met[i - begin];
        if (chunk.flags[i] & kMover) {
          credit_passes(list, chunk.range_m[i], options, said);
        } else {
          credit(model, list, chunk.range_m[i], options, said);
        }
        for (size_t k = 0; k < list.size(); ++k) {
          if (said[k] == Credit::kNothing) continue;
          const bool is_hit = said[k] == Credit::kHit;
          const uint32_t element = list[k].element;
          add_one(is_hit ? of[element].hits : of[element].misses);
          if (element >= meshes) {
            TrialTimes& when = times[element - meshes];
            (is_hit ? when.hits : when.misses).add_shared(chunk.time_s[i] - *zero_s);
          }
          if (is_hit) {
            add_residual(model, list[k], rays[i - begin].direction, chunk.range_m[i], residuals);
          }
        }
      }
    });
    done += chunk.size();
    if (progress) progress(done, source.size());
  }
}

Tally count_hits(elements::Model& model, BeamSource& source, const CreditOptions& options,
                 const std::function<void(size_t, size_t)>& progress) {
  for (size_t i = 0; i < model.size(); ++i) model.hit(i) = {1, 0, 0};
  Tally tally(model, options);
  tally.add(trace::World(model), source, options, progress);
  for (size_t i = 0; i < model.size(); ++i) {
    model.hit(i) = {1, tally.of[i].hits, tally.of[i].misses};
  }
  estimate_hit_probabilities(model, options);
  return tally;
}

void estimate_hit_probabilities(elements::Model& model, const CreditOptions& options) {
  check(options);
  for (size_t i = 0; i < model.size() - model.ellipsoids.size(); ++i) {
    elements::HitCount& h = model.hit(i);
    h.p = float(posterior_mean(trials_of(h), options.triangle));
  }
  for (elements::Ellipsoid& e : model.ellipsoids) {
    e.hit.p = float(posterior_mean(trials_of(e.hit), options.ellipsoid));
  }
}

}  // namespace underbrush::credit
