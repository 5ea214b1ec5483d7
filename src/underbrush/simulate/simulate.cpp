#include "underbrush/simulate/simulate.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/keyframes/recollection.hpp"
#include "underbrush/simulate/draw.hpp"
#include "underbrush/simulate/element_class.hpp"
#include "underbrush/simulate/median.hpp"

namespace underbrush::simulate {
namespace {

using trace::Intersection;

// Draws a point of the element's Gaussian, world frame.
Vec3 drawn_in_volume(const elements::Model& model, const elements::Instance& placed,
                     const Intersection& met, uint64_t key) {
  const elements::Ellipsoid& e = model.ellipsoids[model.place(met.element).index];
  Vec3 n;
  for (uint32_t k = 0; k < 3; ++k) {
    n[k] = normal(mix64(key + k), met.element, Purpose::kRange);
  }
  const Mat3 root = Eigen::LLT<Mat3>(e.covariance_matrix()).matrixL();
  return placed.world_from_model * Vec3(double(placed.scale) * (e.mean.cast<double>() + root * n));
}

void check(const DynamicWorld& world, const Options& options) {
  if (options.random_ray) options.random_ray->check();
  require((world.world().draws() == trace::Draws::kSwaying) == (options.sway_s > 0),
          "simulate: a world sways if it is given a correlation time");
  require(options.draw != RangeDraw::kMedian ||
              (!options.random_ray && options.sway_s == 0 && !world.moves()),
          "simulate: the median is of thin rays in a world in which nothing moves or sways");
}

trace::RangeLimits limits_of(const DynamicWorld& world, const Options& options,
                             const LogInfo& info) {
  const double farthest = options.max_range_m > 0 ? options.max_range_m : info.max_range_m;
  return {std::max(info.min_range_m, kLeastRangeM), std::min(farthest, world.model(0).max_range_m)};
}

void make_miss(BeamLog& beams, size_t i) {
  beams.range_m[i] = kMiss;
  beams.intensity[i] = 0;
  beams.flags[i] = 0;
}

double with_noise(double range_m, const Options& options, uint64_t key) {
  if (!(options.range_noise_m > 0)) return range_m;
  return range_m + options.range_noise_m * normal(key, Intersection::kNone, Purpose::kNoise);
}

/// Answers a beam as a keyframe does.
void set_recalled(const keyframes::RecalledReturn& seen, const Options& options,
                  const trace::RangeLimits& limits, uint64_t key, BeamLog& beams, size_t i) {
  if (!(seen.range_m >= limits.min_m && seen.range_m <= limits.max_m)) return;
  const double range = with_noise(seen.range_m, options, key);
  beams.range_m[i] = float(std::clamp(range, limits.min_m, limits.max_m));
  beams.intensity[i] =
      options.intensity == IntensityDraw::kMean ? seen.mean_intensity : seen.intensity;
}

/// The way from a ray's origin to a point that is drawn in the ellipsoid that it met.
Vec3 to_drawn_point(const DynamicWorld& world, double time_s, const Ray& ray,
                    const Intersection& met, uint64_t key) {
  const elements::Instance placed = world.placed(met.instance, time_s);
  return drawn_in_volume(world.model(met.instance), placed, met, key) - ray.origin;
}

/// The extra columns of `Options::element_ids`.
class ElementColumns {
 public:
  ElementColumns(const Options& options, size_t beams)
      : options_(options),
        element_(options.element_ids ? beams : 0, Intersection::kNone),
        label_(element_.size()),
        instance_(options.instance_labels.empty() ? 0 : element_.size()) {}

  void set(size_t i, const elements::Model& model, const Intersection& met) {
    if (element_.empty()) return;
    element_[i] = met.element;
    label_[i] = element_class(model, met, options_.instance_labels);
    if (!instance_.empty()) instance_[i] = met.instance;
  }
  void give_to(BeamLog& beams) {
    if (!options_.element_ids) return;
    beams.extra["element"] = std::move(element_);
    beams.extra["element_class"] = std::move(label_);
    if (!options_.instance_labels.empty()) beams.extra["instance"] = std::move(instance_);
  }

 private:
  const Options& options_;
  std::vector<uint32_t> element_;
  std::vector<uint16_t> label_;
  std::vector<uint32_t> instance_;
};

/// What the keyframes answer to some beams; nothing where it is for the elements, of which the
/// beams met one or none. Only the beams that keyframes may answer look at them. Unless `matter` is
/// null, matter is drawn once, and the beams that meet it in the same patch of pixels choose and
/// err alike, because the pixels bring the sensor's own noise with them. Keyframes know nothing of
/// elements, of moving objects or of scenes, and only of beams along their axes.
std::vector<std::optional<keyframes::RecalledReturn>> recalled(
    const keyframes::Recollection& memory, std::span<const Ray> rays,
    std::span<const uint16_t> rings, std::span<const Intersection> met,
    std::span<const uint64_t> keys, const uint64_t* matter) {
  constexpr double kFarM = 100;  // where the pixel of a miss is looked for
  std::vector<std::optional<keyframes::RecalledReturn>> out(rays.size());
  std::vector<keyframes::Recollection::Asked> asked = memory.asked(rays, rings);
  std::vector<uint32_t> number;
  std::vector<uint64_t> choices;
  for (uint32_t k = 0; k < rays.size(); ++k) {
    keyframes::Recollection::Asked& beam = asked[k];
    const double most = memory.most_recalled(beam.near);
    if (!(most > 0)) continue;
    uint64_t choice = keys[k];
    if (matter) {
      const Vec3 end = rays[k].origin + (met[k].none() ? kFarM : met[k].t_m) * rays[k].direction;
      choice = mix64(*matter ^ mix64(memory.patch_of(end, beam.near)));
    }
    beam.u = uniform_from_bits(random_bits(choice, 0, Purpose::kRecall));
    if (beam.u >= most) continue;
    asked[number.size()] = beam;
    number.push_back(k);
    choices.push_back(choice);
  }
  asked.resize(number.size());
  const std::vector<keyframes::Recalled> seen = memory.recall(asked);
  for (size_t j = 0; j < seen.size(); ++j) {
    out[number[j]] = memory.drawn(seen[j], asked[j].u, choices[j]);
  }
  return out;
}

/// Beams, ready to be traced. Where matter is drawn once, its trials have keys of their own.
struct Shots {
  std::vector<Ray> rays;
  std::vector<uint64_t> keys, trials;

  Shots(const Options& options, size_t first_beam, bool once, const BeamLog& beams, size_t begin,
        size_t end) {
    const uint64_t matter = matter_key(options.seed);
    rays.reserve(end - begin);
    for (size_t i = begin; i < end; ++i) {
      keys.push_back(beam_key(options.seed, beams.scan[i], first_beam + i));
      trials.push_back(once ? matter_at(matter, beams.time_s[i], options.sway_s) : keys.back());
      const Ray ray = beams.ray(i);
      rays.push_back(options.random_ray ? sensor::random_ray(sensor::beam_axes(ray),
                                                             *options.random_ray, keys.back())
                                        : ray);
    }
  }
};

/// Where some beams end: at an element, as a keyframe says, or nowhere.
struct Ends {
  std::vector<Intersection> met;
  std::vector<std::optional<keyframes::RecalledReturn>> seen;
  std::vector<double> median_m;  ///< m; the ranges, if they are medians and are not to be drawn.
};

Ends median_ends(const DynamicWorld& world, const keyframes::Recollection* memory,
                 std::span<const Ray> rays, std::span<const uint16_t> rings,
                 const trace::RangeLimits& limits) {
  Ends out;
  for (const MedianAnswer& a : median_answers(world.world(), memory, rays, rings, limits)) {
    out.met.push_back(a.met);
    out.seen.push_back(a.seen);
    out.median_m.push_back(a.range_m);
  }
  return out;
}

/// Unless `matter` is null, matter is drawn once.
Ends drawn_ends(const DynamicWorld& world, const keyframes::Recollection* memory,
                const Shots& shots, std::span<const uint16_t> rings, std::span<const double> time_s,
                const uint64_t* matter, const trace::RangeLimits& limits) {
  Ends out;
  out.met.resize(rings.size());
  out.seen.resize(rings.size());
  world.nearest_accepted(shots.rays, shots.trials, time_s, limits, out.met);
  if (memory) out.seen = recalled(*memory, shots.rays, rings, out.met, shots.keys, matter);
  return out;
}

}  // namespace

bool keyframes_serve(const DynamicWorld& world, const Options& options, const LogInfo& beams) {
  const bool plain = options.draw != RangeDraw::kVolumetric && !options.random_ray &&
                     !options.element_ids && options.sway_s == 0;
  return plain && !world.moves() && world.world().is_one_model() &&
         keyframes::Recollection::serves(world.model(0), beams);
}

void simulate(const DynamicWorld& world, const Options& options, size_t first_beam,
              BeamLog& beams) {
  check(world, options);
  const trace::RangeLimits limits = limits_of(world, options, beams.info);
  const bool once = world.world().draws() != trace::Draws::kAnew;
  const uint64_t matter = matter_key(options.seed);
  std::optional<keyframes::Recollection> memory;
  if (keyframes_serve(world, options, beams.info)) memory.emplace(world.model(0));
  ElementColumns columns(options, beams.size());
  parallel_for(beams.size(), 8192, [&](size_t begin, size_t end) {
    const size_t n = end - begin;
    const Shots shots(options, first_beam, once, beams, begin, end);
    const std::span<const uint16_t> rings(&beams.ring[begin], n);
    const keyframes::Recollection* known = memory ? &*memory : nullptr;
    const Ends ends = options.draw == RangeDraw::kMedian
                          ? median_ends(world, known, shots.rays, rings, limits)
                          : drawn_ends(world, known, shots, rings, {&beams.time_s[begin], n},
                                       once ? &matter : nullptr, limits);
    const auto& [rays, keys, trials] = shots;
    MatterAt matter_of(world);
    LearntLight light(world, beams.info, options.intensity);
    for (size_t k = 0; k < n; ++k) {
      const size_t i = begin + k;
      make_miss(beams, i);
      if (ends.seen[k]) {
        set_recalled(*ends.seen[k], options, limits, keys[k], beams, i);
        continue;
      }
      const Intersection& met = ends.met[k];
      if (met.none()) continue;
      const elements::Model& model = matter_of.model(met, beams.time_s[i]);
      columns.set(i, model, met);
      double range = 0;
      if (!ends.median_m.empty()) {
        range = ends.median_m[k];
      } else if (once) {
        const uint32_t cell = matter_of.cell(rays[k], beams.time_s[i], met, trials[k]);
        range = drawn_in_matter(met, trace::instance_key(matter, met.instance) ^ cell, keys[k],
                                model.range_noise_m, limits);
      } else {
        range = drawn_on_ray(met, keys[k], limits);
      }
      if (options.draw == RangeDraw::kVolumetric &&
          model.kind(met.element) == elements::Kind::kEllipsoid) {
        const Vec3 to = to_drawn_point(world, beams.time_s[i], rays[k], met, keys[k]);
        range = to.norm();
        beams.direction[i] = to.normalized().cast<float>();
      }
      range = with_noise(range, options, keys[k]);
      beams.range_m[i] = float(std::clamp(range, limits.min_m, limits.max_m));
      beams.intensity[i] = light.intensity(model, rays[k], met, beams, i, keys[k]);
    }
  });
  columns.give_to(beams);
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
