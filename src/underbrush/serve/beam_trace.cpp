#include "underbrush/serve/beam_trace.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "underbrush/pipeline/explanation.hpp"
#include "underbrush/serve/json_reply.inl"
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

// The name of a class, which may be one of the scene's own.
std::string class_of(uint16_t label, const std::vector<std::string>& own) {
  if (label < own.size()) return own[label];
  return label < elements::kClassNames.size() ? std::string(elements::kClassNames[label])
                                              : std::to_string(label);
}

}  // namespace

std::string trace_beam(const LoggedBeam& beam, const WorldData& world, uint64_t seed,
                       bool keyframes) {
  BeamLog rows = beam.rows;
  keep_first_echoes(rows);
  const pipeline::TracedWorld& traced = world.traced();
  const pipeline::Explanation why =
      pipeline::explain_beam(traced, seed, keyframes, beam.number, rows);
  const std::vector<std::string> own_classes = elements::element_classes(world.info());
  const auto range = [](float r) { return r == kMiss ? Json(nullptr) : Json(r); };
  Json j{{"row", beam.first + beam.asked}, {"beam", beam.number}, {"seed", seed}};
  j["real_range_m"] = range(beam.rows.range_m[0]);
  j["min_range_m"] = why.limits.min_m;
  j["max_range_m"] = why.limits.max_m;
  j["met_in_all"] = why.met.size();
  j["met"] = Json::array();
  for (size_t k = 0; k < std::min(why.met.size(), kMostMet); ++k) {
    const pipeline::MetElement& e = why.met[k];
    const elements::Model& model = traced.dynamic().model(e.met.instance);
    const elements::ElementPlace place = model.place(e.met.element);
    const elements::HitCount& hit = model.hit(e.met.element);
    j["met"].push_back(
        {{"range_m", e.met.t_m},
         {"sigma_m", e.met.sigma_m},
         {"distance", std::sqrt(e.met.delta2)},
         {"p", e.met.p},
         {"draw", e.draw},
         {"accepts", e.accepts},
         {"reach", e.reach},
         {"kind", name_of(place.kind)},
         {"index", place.index},
         {"element", e.met.element},
         {"instance", e.met.instance},
         {"class",
          class_of(simulate::element_class(model, e.met, world.info().labels), own_classes)},
         {"hits", hit.hits},
         {"misses", hit.misses}});
  }
  j["miss_probability"] = why.miss_probability;
  j["unknown_probability"] = why.unknown_probability;
  constexpr const char* kEnds[] = {"miss", "element", "keyframe", "unknown space"};
  j["ends_by"] = kEnds[size_t(why.ends_by)];
  j["ends_at"] = why.ends_at ? Json(*why.ends_at) : Json(nullptr);
  j["simulated_range_m"] = range(why.range_m);
  return text_of(j);
}

}  // namespace underbrush::serve
