#include "underbrush/pipeline/explanation.hpp"

#include <algorithm>
#include <memory>

#include "underbrush/core/rng.hpp"
#include "underbrush/simulate/draw.hpp"

namespace underbrush::pipeline {
namespace {

/// A world with its objects at one time; the world itself where nothing moves.
struct AtATime {
  AtATime(const TracedWorld& world, double time_s) : tracer(&world.still()) {
    if (!world.dynamic().moves()) return;
    scene.models = world.scene()->models;
    for (uint32_t k = 0; k < world.scene()->instances.size(); ++k) {
      scene.instances.push_back(world.dynamic().placed(k, time_s));
      scene.instances.back().model = world.scene()->instances[k].model;
    }
    own = std::make_unique<trace::World>(scene, trace::Isa::kBest, world.still().draws());
    tracer = own.get();
  }
  elements::Scene scene;
  std::unique_ptr<trace::World> own;
  const trace::World* tracer;
};

/// The cell of the grain in which a ray met an element; where matter sways, at the time of the key
/// of its trials.
uint32_t cell_of(const trace::World& tracer, const Ray& ray, const trace::Intersection& met,
                 uint64_t trial) {
  const elements::Model& model = tracer.model(met.instance);
  const uint32_t cell = trace::Grain(model, tracer.instance(met.instance)).cell(ray, met);
  const bool sways = tracer.draws() == trace::Draws::kSwaying &&
                     model.kind(met.element) == elements::Kind::kEllipsoid;
  return sways ? trace::swaying_cell(cell, met.element, uint32_t(trial >> 32)) : cell;
}

/// The key of the trials of a beam at the elements of an instance, without the time.
uint64_t trial_key(const TracedWorld& world, uint64_t trial, uint32_t instance) {
  if (world.sway_s() == 0) return trace::instance_key(trial, instance);
  return world.dynamic().moves(instance) ? uint32_t(trace::object_key(trial, instance, true))
                                         : trace::instance_key(uint32_t(trial), instance);
}

/// Whether the beam ends in unknown space before the element at which it would end; then its range
/// is that.
bool end_in_unknown(const trace::World& tracer, const Ray& ray, uint64_t matter,
                    std::span<const trace::Intersection> met, Explanation& out, BeamLog& beam) {
  const trace::UnknownSpace* unknown = tracer.unknown_space();
  if (!unknown) return false;
  std::vector<trace::Intersection> merged;
  double reach = 1;
  for (const trace::Intersection& m : tracer.with_unknown(ray, out.limits, met, merged)) {
    if (m.element == trace::kUnknown) out.unknown_probability += reach * m.p;
    reach *= 1 - m.p;
  }
  out.miss_probability = reach;
  const trace::Intersection ends_at = out.ends_at ? met[*out.ends_at] : trace::Intersection();
  const std::optional<double> end = unknown->drawn_end(ray, matter, out.limits, ends_at);
  if (!end) return false;
  out.ends_at.reset();
  beam.range_m[0] = float(std::clamp(*end, out.limits.min_m, out.limits.max_m));
  return true;
}

}  // namespace

Explanation explain_beam(const TracedWorld& world, uint64_t seed, bool keyframes, size_t number,
                         const BeamLog& beam) {
  SimulateOptions options;
  options.seed = seed;
  options.keyframes = keyframes;
  Simulation simulation(world, options);
  BeamLog answered = beam;
  answered.extra.clear();
  simulation.answer(number, answered);

  const AtATime now(world, beam.time_s[0]);
  const trace::World& tracer = *now.tracer;
  const Ray ray = beam.ray(0);
  Explanation out;
  out.range_m = answered.range_m[0];
  out.limits = {std::max(beam.info.min_range_m, kLeastRangeM),
                std::min(beam.info.max_range_m, tracer.model(0).reach_of(beam.info))};
  std::vector<trace::Intersection> met;
  tracer.all_intersections(ray, out.limits, out.limits.max_m, met);
  const uint64_t matter = simulate::matter_key(seed), key = beam_key(seed, beam.scan[0], number);
  const uint64_t trial = simulate::matter_at(matter, beam.time_s[0], world.sway_s());
  BeamLog by_elements = beam;
  by_elements.extra.clear();
  by_elements.range_m[0] = kMiss;
  double reach = 1;
  for (const trace::Intersection& m : met) {
    const elements::Model& model = tracer.model(m.instance);
    const uint32_t cell = cell_of(tracer, ray, m, trial);
    const uint64_t of_matter = trace::instance_key(matter, m.instance) ^ cell;
    const uint32_t bits = accept_bits(trial_key(world, trial, m.instance) ^ cell, m.element);
    const bool accepts = trace::accept_threshold(m.p).accepts(bits);
    if (accepts && !out.ends_at) {
      out.ends_at = out.met.size();
      const double range =
          simulate::drawn_in_matter(m, of_matter, key, model.range_noise_m, out.limits);
      by_elements.range_m[0] = float(std::clamp(range, out.limits.min_m, out.limits.max_m));
    }
    out.met.push_back({m, double(bits) * 0x1p-32, accepts, reach});
    reach *= 1 - m.p;
  }
  out.miss_probability = reach;
  const bool in_unknown = end_in_unknown(tracer, ray, matter, met, out, by_elements);
  const float drawn = by_elements.range_m[0];
  add_offsets(world.dynamic().model(0).channels_of(beam.info), 1, by_elements);
  if (simulation.keyframes_serve(beam.info) && by_elements.range_m[0] != out.range_m) {
    out.ends_by = EndsBy::kKeyframe;
    out.ends_at.reset();
    return out;
  }
  if (in_unknown) out.ends_by = EndsBy::kUnknownSpace;
  out.offset_m = in_unknown ? by_elements.range_m[0] - drawn : 0;
  if (in_unknown || !out.ends_at) return out;
  out.ends_by = EndsBy::kElement;
  out.offset_m = by_elements.range_m[0] - drawn;
  return out;
}

}  // namespace underbrush::pipeline
