#include "underbrush/pipeline/fit_json.inl"

#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "underbrush/elements/element_light.hpp"
#include "underbrush/fit/refinement_json.inl"
#include "underbrush/io/json_text.inl"

namespace underbrush::pipeline {
namespace {

using Json = nlohmann::ordered_json;

const std::pair<elements::Kind, const char*> kKinds[] = {
    {elements::Kind::kGround, "ground"},
    {elements::Kind::kSurface, "surface"},
    {elements::Kind::kEllipsoid, "ellipsoids"}};

Json places_of(const std::vector<update::ChangedPlace>& places) {
  Json out = Json::array();
  for (const update::ChangedPlace& p : places) {
    out.push_back(
        {{"centre_m", {p.centre.x(), p.centre.y(), p.centre.z()}}, {"ellipsoids", p.gone}});
  }
  return out;
}

void add_model(Json& j, const elements::Model& model) {
  j["ground_triangles"] = model.ground.size();
  j["surface_triangles"] = model.surface.size();
  j["ellipsoids"] = model.ellipsoids.size();
  j["ground_sigma_m"] = model.ground.range_sigma_m;
  j["range_noise_m"] = model.range_noise_m;
  j["sway_s"] = model.sway_s;
  j["grain_m"] = {{"ellipsoids", model.grain.ellipsoid_m}, {"meshes", model.grain.mesh_m}};
  for (const elements::ClassGrain& c : model.grain.classes) {
    j["grain_m"]["classes"][model.class_name(c.label)] = c.side_m;
  }
  if (!model.channels.empty()) j["channels"] = json_of(model.channels);
}

/// The beams of a fit or of an update.
template <class Report>
Json json_of_beams(const elements::Model& model, const Report& r) {
  Json j;
  j["fitter"] = model.fitter;
  j["beams"] = r.beams;
  j["hits"] = r.hits;
  j["misses"] = r.misses;
  if (r.mover_points > 0) j["mover_points"] = r.mover_points;
  return j;
}

}  // namespace

Json json_of(const ChannelOffsets& channels) {
  const OffsetSpread spread = spread_of(channels);
  return {{"range_offsets", channels.size()},
          {"sigma_m", spread.sigma_m},
          {"standard_error_m", spread.standard_error_m}};
}

Json json_of(const elements::Keyframes& k) {
  double bytes = 0;
  for (const elements::Keyframe& f : k.frames) {
    bytes += double(f.pixels.size() * sizeof(elements::KeyframePixel));
  }
  Json j{{"frames", k.frames.size()}, {"rows", k.rows()}, {"columns", k.columns}, {"bytes", bytes}};
  // By the distance to the nearest one: which share of an answer comes from keyframes where the
  // four to eight pixels of a beam agree best, and where they do not.
  for (size_t d = 0; d < elements::Keyframes::kDistances.size(); ++d) {
    const auto weight = [&](size_t agreement) {
      return 1 - k.weights[d * elements::Keyframes::kAgreements + agreement].elements;
    };
    j["trust"].push_back({{"up_to_m", elements::Keyframes::kDistances[d]},
                          {"where_ranges_agree", weight(3)},
                          {"where_they_differ", weight(6)}});
  }
  return j;
}

Json json_of_light(const elements::Model& m) {
  if (!m.light.known()) return nullptr;
  Json j{{"max_intensity", m.light.max_intensity}};
  for (const auto& [kind, name] : kKinds) {
    j["reflectance"][name] = elements::mean_reflectance(m, kind).mean;
  }
  j["range_m"] = m.light.range.at;
  j["range_gain"] = m.light.range.gain;
  j["ring_gain"] = m.light.ring;
  return j;
}

Json json_of_model(const elements::Model& model) {
  Json j{{"kind", "model"}, {"fitter", model.fitter}};
  j["ground_triangles"] = model.whole_count(elements::Kind::kGround);
  j["surface_triangles"] = model.whole_count(elements::Kind::kSurface);
  j["ellipsoids"] = model.whole_count(elements::Kind::kEllipsoid);
  j["tau"] = model.tau;
  j["origin_m"] = {model.origin.x(), model.origin.y(), model.origin.z()};
  j["ground_sigma_m"] = model.ground.range_sigma_m;
  std::map<uint32_t, size_t> classes;
  for (const elements::Ellipsoid& e : model.ellipsoids) ++classes[e.label];
  for (const auto& [label, n] : classes) j["classes"][model.class_name(label)] = n;
  if (!model.channels.empty()) j["channels"] = json_of(model.channels);
  j["sway_s"] = model.sway_s;
  if (model.light.known()) j["light"] = json_of_light(model);
  j["provenance"] = model.provenance.empty() ? Json(nullptr) : io::json_of_text(model.provenance);
  return j;
}

Json json_of(const FittedModel& fitted, const SkippedRows& skipped) {
  const elements::Model& model = fitted.model;
  const fit::FitReport& r = fitted.report;
  Json j = json_of_beams(model, r);
  j["ground_points"] = r.ground_points;
  j["other_points"] = r.other_points;
  j["near_points"] = r.near_points;
  j["carved_triangles"] = r.carved_triangles;
  j["thinned_points"] = r.thinned_points;
  j["unclustered_points"] = r.unclustered_points;
  j["free_space_ellipsoids"] = r.free_space_ellipsoids;
  j["max_range_m"] = model.max_range_m;
  j["tiles"] = r.tiles;
  j["fitted_range_noise_m"] = r.range_noise_m;
  add_model(j, model);
  if (r.grain.learnt()) {
    j["roughness_m"] = {{"log", r.grain.real_m},
                        {"simulated", r.grain.simulated_m},
                        {"simulated_anew", r.grain.anew_m}};
  }
  if (r.leaf_angles.cells > 0) {
    j["leaf_angles"] = {{"cells", r.leaf_angles.cells},
                        {"hits", r.leaf_angles.hits},
                        {"chi", r.leaf_angles.chi},
                        {"deviation", r.leaf_angles.deviation},
                        {"used", r.leaf_angles.used}};
  }
  if (r.sway.known) {
    j["scan_to_scan"] = {{"pairs", r.sway.pairs},
                         {"interval_s", r.sway.interval_s},
                         {"log_m", r.sway.real_m},
                         {"simulated_still_m", r.sway.still_m},
                         {"simulated_anew_m", r.sway.anew_m}};
  }
  if (r.echo_grain.learnt) {
    j["echoes_per_return"] = {{"log", r.echo_grain.real}, {"simulated", r.echo_grain.simulated}};
  }
  if (model.light.known()) j["light"] = json_of_light(model);
  if (model.keyframes) j["keyframes"] = json_of(*model.keyframes);
  if (model.observed) {
    j["observed_space"] = {{"blocks", model.observed->blocks.size()},
                           {"bytes", model.observed->bytes()}};
  }
  j["skipped"] = skipped;
  j["warnings"] = r.warnings;
  if (!r.likelihood.steps.empty()) j["likelihood"] = fit::json_of(r.likelihood);
  j["seconds"] = fitted.seconds;
  j["beams_per_s"] = double(r.beams) / fitted.seconds;
  return j;
}

Json json_of(const UpdatedModel& updated, const SkippedRows& skipped) {
  const elements::Model& model = updated.model;
  const update::UpdateReport& r = updated.report;
  Json j = json_of_beams(model, r);
  j["near_points"] = r.near_points;
  j["unexplained"] = r.unexplained;
  j["earlier_beams"] = r.earlier_beams;
  j["logs"] = updated.training.logs.size();
  j["tiles"] = {{"all", r.tiles}, {"touched", r.touched_tiles}, {"fitted_anew", r.fitted_tiles}};
  j["ellipsoids"] = {{"all", model.ellipsoids.size()}, {"kept", r.kept},       {"added", r.added},
                     {"dropped", r.dropped},           {"changed", r.changed}, {"gone", r.gone}};
  j["gone"] = places_of(r.places);
  j["ground_triangles"] = model.ground.size();
  if (model.keyframes) {
    j["keyframes"] = json_of(*model.keyframes);
    j["keyframes"]["kept"] = r.keyframes.kept;
    j["keyframes"]["added"] = r.keyframes.added;
    j["keyframes"]["forgotten_pixels"] = r.keyframes.forgotten_pixels;
  }
  j["skipped"] = skipped;
  j["warnings"] = r.warnings;
  j["seconds"] = updated.seconds;
  return j;
}

}  // namespace underbrush::pipeline
