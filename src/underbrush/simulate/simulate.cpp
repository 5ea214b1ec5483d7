#include "underbrush/simulate/simulate.hpp"

#include <algorithm>
#include <chrono>

#include "underbrush/core/check.hpp"
#include "underbrush/core/linear.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/simulate/draw.hpp"
#include "underbrush/simulate/element_class.hpp"
#include "underbrush/simulate/median.hpp"

namespace underbrush::simulate {
namespace {

using trace::Intersection;

/// Draws a point of the element's Gaussian (world).
Vec3 drawn_in_volume(const elements::Model& model, const elements::Instance& placed,
                     const Intersection& met, uint64_t key) {
  const elements::Ellipsoid& e = model.ellipsoids[model.place(met.element).index];
  Vec3 n;
  for (uint32_t k = 0; k < 3; ++k) {
    n[k] = normal(mix64(key + k), met.element, Purpose::kRange);
  }
  const Mat3 root = cholesky(e.covariance_matrix());
  return placed.world_from_model * Vec3(double(placed.scale) * (e.mean.cast<double>() + root * n));
}

void check(const DynamicWorld& world, const Options& options) {
  if (options.random_ray) options.random_ray->check();
  require(
      (world.world().draws() == trace::Draws::kSwaying) == (options.sway_s > 0),
      "simulate: sway_s > 0 needs a world whose matter sways, and such a world needs sway_s > 0");
  require(options.draw != RangeDraw::kMedian || (!options.random_ray && !world.moves()),
          "simulate: --draw median needs thin rays and a world without moving objects");
}

trace::RangeLimits limits_of(const DynamicWorld& world, const Options& options,
                             const LogInfo& info) {
  const double farthest = options.max_range_m > 0 ? options.max_range_m : info.max_range_m;
  return {std::max(info.min_range_m, kLeastRangeM),
          std::min(farthest, world.model(0).reach_of(info))};
}

/// The extra columns of `Options::element_ids`.
class ElementColumns {
 public:
  ElementColumns(const trace::World& world, const Options& options, size_t beams)
      : world_(world),
        options_(options),
        element_(options.element_ids ? beams : 0, Intersection::kNone),
        label_(element_.size()),
        instance_(options.instance_labels.empty() ? 0 : element_.size()) {}

  void set(size_t i, const elements::Model& model, const Intersection& met) {
    if (element_.empty()) return;
    element_[i] = met.element;
    label_[i] = element_class(model, met, options_.instance_labels);
    if (!instance_.empty()) instance_[i] = world_.number(met.instance);
  }
  void give_to(BeamLog& beams) {
    if (!options_.element_ids) return;
    beams.extra["element"] = std::move(element_);
    beams.extra["element_class"] = std::move(label_);
    if (!options_.instance_labels.empty()) beams.extra["instance"] = std::move(instance_);
  }

 private:
  const trace::World& world_;
  const Options& options_;
  std::vector<uint32_t> element_;
  std::vector<uint16_t> label_;
  std::vector<uint32_t> instance_;
};

/// What all beams of a call have in common.
struct Simulation {
  const DynamicWorld& world;
  const Options& options;
  trace::RangeLimits limits;
  /// The key of the matter, which is drawn once for all beams; empty where each beam draws it anew.
  std::optional<uint64_t> matter;
  std::optional<keyframes::KeyframeCache> cache;

  Simulation(const DynamicWorld& w, const Options& o, const LogInfo& beams)
      : world(w), options(o), limits(limits_of(w, o, beams)) {
    if (w.world().draws() != trace::Draws::kAnew) matter = matter_key(o.seed);
    if (keyframes_serve(w, o, beams)) cache.emplace(w.model(0));
  }
};

/// The rays of some beams with the keys of their random numbers: those of the beam, and those of
/// the trials at elements, which are the matter's where it is drawn once.
struct Shots {
  std::vector<Ray> rays;
  std::vector<uint64_t> keys, trials;
  std::span<const uint16_t> rings;
  std::span<const double> time_s;

  Shots(const Simulation& s, size_t first_beam, const BeamLog& beams, size_t begin, size_t end)
      : rings(&beams.ring[begin], end - begin), time_s(&beams.time_s[begin], end - begin) {
    const Options& o = s.options;
    rays.reserve(end - begin);
    keys.reserve(end - begin);
    trials.reserve(end - begin);
    for (size_t i = begin; i < end; ++i) {
      keys.push_back(beam_key(o.seed, beams.scan[i], first_beam + i));
      trials.push_back(s.matter ? matter_at(*s.matter, beams.time_s[i], o.sway_s) : keys.back());
      const Ray ray = beams.ray(i);
      rays.push_back(o.random_ray
                         ? sensor::random_ray(sensor::beam_axes(ray), *o.random_ray, keys.back())
                         : ray);
    }
  }
};

/// Calls act(begin, shots) for the beams of a log, some at a time, on all threads.
template <class Act>
void for_shots(const Simulation& s, size_t first_beam, const BeamLog& beams, Act act) {
  constexpr size_t kShots = 8192, kFew = 1024;  // smaller tasks for few beams
  const size_t grain = beams.size() < 8 * kShots ? kFew : kShots;
  parallel_for(beams.size(), grain, [&](size_t begin, size_t end) {
    act(begin, Shots(s, first_beam, beams, begin, end));
  });
}

/// The number of the interval in which a patch of swaying matter has one outcome; each patch begins
/// its intervals at a time of its own. `trial` is a key of `matter_at`.
uint32_t interval_of(uint64_t trial, uint64_t patch) {
  return (uint32_t(trial >> 32) + uint32_t(patch >> 48)) >> 16;
}

/// Draws for each beam whether a pixel of a keyframe determines its return, and if so the return.
/// The result is empty for all other beams, whose returns come from the elements in `met` (one or
/// none for each beam). The cache is queried only for beams whose draw may fall on a pixel. Where
/// matter is drawn once, the beams that meet it in the same patch of pixels share their draw (for
/// the correlation time if it sways), because the pixels contain the noise of the sensor.
std::vector<std::optional<keyframes::CachedReturn>> cached_returns(
    const keyframes::KeyframeCache& cache, const Shots& shots, std::span<const Intersection> met,
    const std::optional<uint64_t>& matter, bool sways) {
  constexpr double kFarM = 100;  // range at which the pixel of a miss is queried
  std::vector<std::optional<keyframes::CachedReturn>> out(met.size());
  std::vector<keyframes::KeyframeCache::Query> queries = cache.queries(shots.rays, shots.rings);
  std::vector<uint32_t> number;
  std::vector<uint64_t> keys;
  for (uint32_t k = 0; k < met.size(); ++k) {
    keyframes::KeyframeCache::Query& query = queries[k];
    const double most = cache.greatest_weight(query.near);
    if (!(most > 0)) continue;
    uint64_t key = shots.keys[k];
    if (matter) {
      const Ray& ray = shots.rays[k];
      const Vec3 end = ray.origin + (met[k].none() ? kFarM : met[k].t_m) * ray.direction;
      uint64_t patch = mix64(cache.patch_of(end, query.near));
      if (sways) patch = mix64(patch + interval_of(shots.trials[k], patch));
      key = mix64(*matter ^ patch);
    }
    query.u = uniform_from_bits(random_bits(key, 0, Purpose::kKeyframe));
    if (query.u >= most) continue;
    queries[number.size()] = query;
    number.push_back(k);
    keys.push_back(key);
  }
  queries.resize(number.size());
  const std::vector<keyframes::CachedPixels> pixels = cache.look_up(queries);
  for (size_t j = 0; j < pixels.size(); ++j) {
    out[number[j]] = cache.drawn(pixels[j], queries[j].u, keys[j]);
  }
  return out;
}

/// The vector from the origin of shot k to a random point in the ellipsoid that it met.
Vec3 to_drawn_point(const DynamicWorld& world, const Shots& shots, size_t k,
                    const Intersection& met) {
  const elements::Instance placed = world.placed(met.instance, shots.time_s[k]);
  return drawn_in_volume(world.model(met.instance), placed, met, shots.keys[k]) -
         shots.rays[k].origin;
}

/// Draws the range (m) along its ray of shot k, which met an element: once for the matter, or anew.
double drawn_range(const Simulation& s, const Shots& shots, size_t k, const Intersection& met,
                   MatterAt& matter_of) {
  if (!s.matter) return drawn_on_ray(met, shots.keys[k], s.limits);
  const double time_s = shots.time_s[k];
  const uint32_t cell = matter_of.cell(shots.rays[k], time_s, met, shots.trials[k]);
  return drawn_in_matter(met, matter_of.key(*s.matter, met, time_s) ^ cell, shots.keys[k],
                         matter_of.model(met, time_s).range_noise_m, s.limits);
}

/// Draws the range at which a shot ends in unknown space, if that is nearer than the element it
/// met; infinite if it is not.
double drawn_in_unknown(const Simulation& s, const Shots& shots, size_t k,
                        const Intersection& met) {
  const trace::UnknownSpace* unknown = s.world.world().unknown_space();
  if (!unknown) return HUGE_VAL;
  return unknown->drawn_end(shots.rays[k], s.matter.value_or(shots.keys[k]), s.limits, met)
      .value_or(HUGE_VAL);
}

/// Finds the element at which each shot ends, or draws a pixel of a keyframe. Pixels contain the
/// static world alone, so a moving object that is nearer hides them.
CachedReturns nearest_answers(const Simulation& s, const Shots& shots,
                              std::span<Intersection> met) {
  if (!s.cache) {
    s.world.nearest_accepted(shots.rays, shots.trials, shots.time_s, s.limits, met);
    return CachedReturns(met.size());
  }
  s.world.world().nearest_accepted(shots.rays, shots.trials, s.limits, met);
  CachedReturns cached = cached_returns(*s.cache, shots, met, s.matter, s.options.sway_s > 0);
  if (!s.world.moves()) return cached;
  for (size_t k = 0; k < met.size(); ++k) {
    if (!cached[k]) continue;
    met[k] = {};
    if (!(cached[k]->range_m <= s.limits.max_m)) continue;
    met[k].element = trace::kUnknown;  // anything that ends the ray there
    met[k].t_m = cached[k]->range_m;
  }
  s.world.meet_movers(shots.rays, shots.trials, shots.time_s, s.limits, met);
  for (size_t k = 0; k < met.size(); ++k) {
    if (!met[k].none() && s.world.moves(met[k].instance)) cached[k].reset();
  }
  return cached;
}

/// Draws the answer to each shot: the nearest element that accepts it, what is in unknown space
/// before that or a pixel of a keyframe, and then the range.
std::vector<BeamAnswer> drawn_answers(const Simulation& s, const Shots& shots) {
  // Copies of a value are made faster than values that the vector sets to zero first.
  std::vector<Intersection> met(shots.rays.size(), Intersection{});
  const CachedReturns cached = nearest_answers(s, shots, met);
  std::vector<BeamAnswer> out(met.size(), BeamAnswer{});
  MatterAt matter_of(s.world);
  for (size_t k = 0; k < out.size(); ++k) {
    if (cached[k]) {
      out[k].cached = cached[k];
      continue;
    }
    if (const double end = drawn_in_unknown(s, shots, k, met[k]); end < HUGE_VAL) {
      out[k].met.element = trace::kUnknown;
      out[k].range_m = end;
      continue;
    }
    if (met[k].none()) continue;
    out[k].met = met[k];
    const elements::Model& model = matter_of.model(met[k], shots.time_s[k]);
    if (s.options.draw == RangeDraw::kVolumetric &&
        model.kind(met[k].element) == elements::Kind::kEllipsoid) {
      const Vec3 to = to_drawn_point(s.world, shots, k, met[k]);
      out[k].range_m = to.norm();
      out[k].direction = to.normalized().cast<float>();
    } else {
      out[k].range_m = drawn_range(s, shots, k, met[k], matter_of);
    }
  }
  return out;
}

/// The range as it is reported: with further noise and within the limits.
float reported(const Simulation& s, double range_m, uint64_t key) {
  const double sigma_m = s.options.range_noise_m;
  if (sigma_m > 0) range_m += sigma_m * normal(key, Intersection::kNone, Purpose::kNoise);
  return float(std::clamp(range_m, s.limits.min_m, s.limits.max_m));
}

/// Writes the answers of shots into their rows, which begin at `begin`.
void write(const Simulation& s, const Shots& shots, std::span<const BeamAnswer> answers,
           size_t begin, BeamLog& beams, ElementColumns& columns) {
  MatterAt matter_of(s.world);
  LearntLight light(s.world, beams.info, s.options.intensity);
  for (size_t k = 0; k < answers.size(); ++k) {
    const size_t i = begin + k;
    const auto& [range_m, met, cached, direction] = answers[k];
    beams.range_m[i] = kMiss;
    beams.intensity[i] = 0;
    beams.flags[i] = 0;
    if (cached) {
      if (!(cached->range_m >= s.limits.min_m && cached->range_m <= s.limits.max_m)) continue;
      beams.range_m[i] = reported(s, cached->range_m, shots.keys[k]);
      const bool mean = s.options.intensity == IntensityDraw::kMean;
      beams.intensity[i] = mean ? cached->mean_intensity : cached->intensity;
    } else if (met.element == trace::kUnknown) {
      beams.range_m[i] = reported(s, range_m, shots.keys[k]);
      beams.intensity[i] =
          light.of_unknown(shots.rays[k], double(beams.range_m[i]), beams, i, shots.keys[k]);
    } else if (!met.none()) {
      const elements::Model& model = matter_of.model(met, beams.time_s[i]);
      columns.set(i, model, met);
      if (direction) beams.direction[i] = *direction;
      beams.range_m[i] = reported(s, range_m, shots.keys[k]);
      beams.intensity[i] = light.intensity(model, shots.rays[k], met, double(beams.range_m[i]),
                                           beams, i, shots.keys[k]);
    }
  }
}

}  // namespace

bool keyframes_serve(const DynamicWorld& world, const Options& options, const LogInfo& beams) {
  const bool plain = options.keyframes && options.draw != RangeDraw::kVolumetric &&
                     !options.random_ray && !options.element_ids;
  return plain && world.stands_as_one_model() &&
         keyframes::KeyframeCache::serves(world.model(0), beams);
}

void simulate(const DynamicWorld& world, const Options& options, size_t first_beam,
              BeamLog& beams) {
  check(world, options);
  const Simulation simulation(world, options, beams.info);
  const keyframes::KeyframeCache* cache = simulation.cache ? &*simulation.cache : nullptr;
  ElementColumns columns(world.world(), options, beams.size());
  for_shots(simulation, first_beam, beams, [&](size_t begin, const Shots& shots) {
    const std::vector<BeamAnswer> answers =
        options.draw == RangeDraw::kMedian
            ? median_answers(world.world(), cache, shots.rays, shots.rings, simulation.limits)
            : drawn_answers(simulation, shots);
    write(simulation, shots, answers, begin, beams, columns);
  });
  columns.give_to(beams);
}

CachedReturns keyframe_answers(const DynamicWorld& world, const Options& options, size_t first_beam,
                               const BeamLog& beams) {
  if (!keyframes_serve(world, options, beams.info)) return {};
  const Simulation simulation(world, options, beams.info);
  CachedReturns out(beams.size());
  for_shots(simulation, first_beam, beams, [&](size_t begin, const Shots& shots) {
    std::vector<Intersection> met(shots.rays.size());
    CachedReturns some = nearest_answers(simulation, shots, met);
    std::move(some.begin(), some.end(), out.begin() + std::ptrdiff_t(begin));
  });
  return out;
}

SimulatedSource::SimulatedSource(Answer answer, BeamSource& beams, double max_range_m)
    : answer_(std::move(answer)), beams_(beams), info_(beams.info()) {
  info_.has_misses = true;
  if (max_range_m > 0) info_.max_range_m = max_range_m;
}

SimulatedSource::SimulatedSource(const trace::World& world, BeamSource& beams,
                                 const Options& options)
    : SimulatedSource(
          [&world, options](size_t first_beam, BeamLog& chunk) {
            simulate(world, options, first_beam, chunk);
          },
          beams, options.max_range_m) {}

void SimulatedSource::rewind() {
  beams_.rewind();
  done_ = hits_ = rows_ = 0;
  seconds_ = 0;
}

bool SimulatedSource::next(BeamLog& chunk) {
  using Clock = std::chrono::steady_clock;
  if (!beams_.next(chunk)) return false;
  chunk.info = info_;
  const size_t fired = chunk.size();
  const auto start = Clock::now();
  answer_(done_, chunk);
  seconds_ += std::chrono::duration<double>(Clock::now() - start).count();
  done_ += fired;
  rows_ += chunk.size();
  for (size_t i = 0; i < chunk.size(); ++i) hits_ += chunk.is_hit(i);
  return true;
}

}  // namespace underbrush::simulate
