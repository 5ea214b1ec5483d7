#include "underbrush/osi/traced_part.hpp"

#include "underbrush/simulate/draw.hpp"

namespace underbrush::osi {
namespace {

using trace::Intersection;

trace::World world_of(const elements::Scene& scene, double sway_s) {
  const trace::Draws draws = sway_s > 0 ? trace::Draws::kSwaying : trace::Draws::kOnce;
  return scene.instances.empty() ? trace::World(scene.models.at(0), trace::Isa::kBest, draws)
                                 : trace::World(scene, trace::Isa::kBest, draws);
}

simulate::Reflection reflection_of(const elements::Scene& scene, const elements::SceneInfo& info,
                                   const radiometry::Materials& materials, double wavelength_m) {
  const simulate::InstanceKinds kinds = simulate::instance_kinds(scene, info);
  return {simulate::with_own_materials(materials, kinds), wavelength_m, kinds};
}

}  // namespace

TracedPart::TracedPart(elements::Scene scene, const elements::SceneInfo& info,
                       const radiometry::Materials& materials, double wavelength_m)
    : scene_(std::move(scene)),
      sway_s_(elements::sway_of(scene_.models)),
      world_(world_of(scene_, sway_s_)),
      dynamic_(world_),
      reflection_(reflection_of(scene_, info, materials, wavelength_m)) {}

void TracedPart::trace(std::span<const Ray> rays, std::span<const uint64_t> keys, uint64_t seed,
                       double time_s, const trace::RangeLimits& limits, uint32_t first_instance,
                       std::span<Meeting> nearest) const {
  const uint64_t matter = simulate::matter_key(seed);
  const uint64_t matter_now = simulate::matter_at(matter, time_s, sway_s_);
  const std::vector<uint64_t> trials(rays.size(), matter_now);
  const std::vector<double> times(rays.size(), time_s);
  std::vector<Intersection> met(rays.size());
  dynamic_.nearest_accepted(rays, trials, times, limits, met);
  if (const trace::UnknownSpace* unknown = world_.unknown_space()) {
    for (size_t k = 0; k < met.size(); ++k) {
      const auto end = unknown->drawn_end(rays[k], matter, limits, met[k]);
      if (end) met[k] = {*end, 0, 0, 1, trace::kUnknown, 0};
    }
  }
  std::vector<uint32_t> hit;
  for (uint32_t k = 0; k < met.size(); ++k) {
    const bool is_nearer = nearest[k].range_m == 0 || met[k].t_m < nearest[k].range_m;
    if (!met[k].none() && is_nearer) hit.push_back(k);
  }
  std::vector<float> factor(hit.size());
  simulate::Reflection::Evaluator evaluator(reflection_, dynamic_);
  simulate::MatterAt matter_at(dynamic_);
  for (size_t i = 0; i < hit.size(); ++i) {
    const uint32_t k = hit[i];
    evaluator.begin(rays[k].direction, time_s);
    evaluator.factors(met, rays, {&hit[i], 1}, {&factor[i], 1});
    if (met[k].element == trace::kUnknown) {
      nearest[k] = {met[k].t_m, double(factor[i]), first_instance};
      continue;
    }
    const uint64_t own =
        matter_at.key(matter, met[k], time_s) ^ matter_at.cell(rays[k], time_s, met[k], matter_now);
    const double range = simulate::drawn_in_matter(
        met[k], own, keys[k], matter_at.model(met[k], time_s).range_noise_m, limits);
    nearest[k] = {range, double(factor[i]), first_instance + met[k].instance};
  }
}

}  // namespace underbrush::osi
