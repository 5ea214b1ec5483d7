#include "underbrush/serve/beam_trace.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "underbrush/core/rng.hpp"
#include "underbrush/serve/json_reply.inl"
#include "underbrush/simulate/draw.hpp"
#include "underbrush/simulate/dynamic_world.hpp"
#include "underbrush/simulate/element_class.hpp"

namespace underbrush::serve {
namespace {

constexpr size_t kMostMet = 1000;

const char* name_of(elements::Kind kind) {
  switch (kind) {
    case elements::Kind::kGround:
      return "ground";
    case elements::Kind::kSurface:
      return "surface";
    case elements::Kind::kEllipsoid:
      break;
  }
  return "ellipsoid";
}

// A world with its objects at one time; the world itself where nothing moves.
struct AtATime {
  AtATime(const WorldData& world, double time_s) : tracer(&world.tracer()) {
    if (world.info().movers.empty()) return;
    const simulate::DynamicWorld moving(world.scene(), world.info().movers, trace::Draws::kOnce);
    scene.models = world.scene().models;
    for (uint32_t k = 0; k < world.scene().instances.size(); ++k) {
      scene.instances.push_back(moving.placed(k, time_s));
      scene.instances.back().model = world.scene().instances[k].model;
    }
    own = std::make_unique<trace::World>(scene, trace::Isa::kBest, trace::Draws::kOnce);
    tracer = own.get();
  }
  elements::Scene scene;
  std::unique_ptr<trace::World> own;
  const trace::World* tracer;
};

// The name of a class, which may be one of the scene's own.
std::string class_of(uint16_t label, const std::vector<std::string>& own) {
  if (label < own.size()) return own[label];
  return label < elements::kClassNames.size() ? std::string(elements::kClassNames[label])
                                              : std::to_string(label);
}

}  // namespace

std::string trace_beam(const LoggedBeam& beam, const WorldData& world, uint64_t seed) {
  const BeamLog& log = beam.rows;
  const AtATime now(world, log.time_s[0]);
  const trace::World& tracer = *now.tracer;
  const Ray ray = log.ray(0);
  const trace::RangeLimits limits{std::max(log.info.min_range_m, kLeastRangeM),
                                  std::min(log.info.max_range_m, tracer.model(0).max_range_m)};
  const std::vector<std::string> own_classes = elements::element_classes(world.info());
  std::vector<trace::Intersection> met;
  tracer.all_intersections(ray, limits, limits.max_m, met);
  const uint64_t matter = simulate::matter_key(seed);
  const uint64_t key = beam_key(seed, log.scan[0], beam.number);
  Json j{{"row", beam.first + beam.asked}, {"beam", beam.number}, {"seed", seed}};
  j["real_range_m"] = log.is_hit(0) ? Json(log.range_m[0]) : Json(nullptr);
  j["min_range_m"] = limits.min_m;
  j["max_range_m"] = limits.max_m;
  j["met_in_all"] = met.size();
  j["met"] = Json::array();
  j["ends_at"] = nullptr;
  j["simulated_range_m"] = nullptr;
  double reach = 1;
  for (size_t k = 0; k < met.size(); ++k) {
    const trace::Intersection& m = met[k];
    const elements::Model& model = tracer.model(m.instance);
    const elements::ElementPlace place = model.place(m.element);
    const uint32_t cell = trace::Grain(model, tracer.instance(m.instance)).cell(ray, m);
    const uint32_t bits = accept_bits(trace::instance_key(matter, m.instance) ^ cell, m.element);
    const bool accepts = trace::accepts(matter, m, cell);
    if (accepts && j["ends_at"].is_null()) {
      j["ends_at"] = k;
      j["simulated_range_m"] = float(
          std::clamp(simulate::drawn_in_matter(m, trace::instance_key(matter, m.instance) ^ cell,
                                               key, model.range_noise_m, limits),
                     limits.min_m, limits.max_m));
    }
    if (k < kMostMet) {
      const uint16_t label = simulate::element_class(model, m, world.info().labels);
      const elements::HitCount& hit = model.hit(m.element);
      j["met"].push_back({{"range_m", m.t_m},
                          {"sigma_m", m.sigma_m},
                          {"distance", std::sqrt(m.delta2)},
                          {"p", m.p},
                          {"draw", double(bits) * 0x1p-32},
                          {"accepts", accepts},
                          {"reach", reach},
                          {"kind", name_of(place.kind)},
                          {"index", place.index},
                          {"element", m.element},
                          {"instance", m.instance},
                          {"class", class_of(label, own_classes)},
                          {"hits", hit.hits},
                          {"misses", hit.misses}});
    }
    reach *= 1 - m.p;
  }
  j["miss_probability"] = reach;
  return j.dump();
}

}  // namespace underbrush::serve
