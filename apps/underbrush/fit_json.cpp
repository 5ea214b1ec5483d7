#include "fit_json.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "light_report.hpp"

namespace underbrush::app {

Json json_of(const likelihood::LikelihoodReport& report) {
  Json j;
  j["training_beams"] = report.training_beams;
  j["held_out_beams"] = report.held_out_beams;
  j["stray_hits"] = report.stray_hits;
  for (const likelihood::LikelihoodStep& s : report.steps) {
    Json step = {{"name", s.name}, {"elements", s.elements}};
    if (s.training_nll) step["training_nll"] = *s.training_nll;
    step["held_out_nll"] = s.held_out_nll;
    step["accepted"] = s.accepted;
    j["steps"].push_back(std::move(step));
  }
  return j;
}

Json json_of(const ChannelOffsets& channels) {
  const OffsetSpread spread = spread_of(channels);
  return {{"range_offsets", channels.size()},
          {"sigma_m", spread.sigma_m},
          {"standard_error_m", spread.standard_error_m}};
}

std::string text_of_channels(const ChannelOffsets& channels) {
  if (channels.empty()) return "";
  const OffsetSpread spread = spread_of(channels);
  return fmt::format("  channels    {} range offsets, sigma {:.1f} cm, standard error {:.1f} cm\n",
                     channels.size(), 100 * spread.sigma_m, 100 * spread.standard_error_m);
}

Json json_of(const elements::Keyframes& k) {
  double bytes = 0;
  for (const elements::Keyframe& f : k.frames) {
    bytes += double(f.pixels.size() * sizeof(elements::KeyframePixel));
  }
  Json j{{"frames", k.frames.size()}, {"rows", k.rows()}, {"columns", k.columns}, {"bytes", bytes}};
  // By the distance to the nearest one: how much of an answer is remembered where the four to eight
  // pixels of a beam agree best, and where they do not.
  for (size_t d = 0; d < elements::Keyframes::kDistances.size(); ++d) {
    const auto weight = [&](size_t agreement) {
      return 1 - k.trust[d * elements::Keyframes::kAgreements + agreement].elements;
    };
    j["trust"].push_back({{"up_to_m", elements::Keyframes::kDistances[d]},
                          {"where_ranges_agree", weight(3)},
                          {"where_they_differ", weight(6)}});
  }
  return j;
}

std::string text_of_keyframes(const elements::Model& model) {
  if (!model.keyframes) return "";
  const Json j = json_of(*model.keyframes);
  std::string text = fmt::format("  keyframes   {} of {} x {} pixels, {:.1f} MB; remembered",
                                 j["frames"].get<size_t>(), j["rows"].get<size_t>(),
                                 j["columns"].get<size_t>(), j["bytes"].get<double>() / 1e6);
  for (const Json& d : j["trust"]) {
    const double agreed = d["where_ranges_agree"], differ = d["where_they_differ"];
    if (agreed == 0 && differ == 0) continue;
    text += fmt::format(" {:.0f} to {:.0f} % up to {:g} m,", 100 * std::min(agreed, differ),
                        100 * std::max(agreed, differ), d["up_to_m"].get<double>());
  }
  text.back() = '\n';
  return text;
}

Json json_of(const FitStep& step) {
  const elements::Model& model = step.result.model;
  const fit::FitReport& r = step.result.report;
  Json j;
  j["fitter"] = model.fitter;
  j["beams"] = r.beams;
  j["hits"] = r.hits;
  j["misses"] = r.misses;
  if (r.mover_points > 0) j["mover_points"] = r.mover_points;
  j["ground_points"] = r.ground_points;
  j["other_points"] = r.other_points;
  j["near_points"] = r.near_points;
  j["carved_triangles"] = r.carved_triangles;
  j["thinned_points"] = r.thinned_points;
  j["unclustered_points"] = r.unclustered_points;
  j["free_space_ellipsoids"] = r.free_space_ellipsoids;
  j["max_range_m"] = model.max_range_m;
  j["tiles"] = r.tiles;
  j["ground_triangles"] = model.ground.size();
  j["surface_triangles"] = model.surface.size();
  j["ellipsoids"] = model.ellipsoids.size();
  j["ground_sigma_m"] = model.ground.range_sigma_m;
  j["range_noise_m"] = model.range_noise_m;
  j["grain_m"] = {{"ellipsoids", model.grain.ellipsoid_m}, {"meshes", model.grain.mesh_m}};
  for (const elements::ClassGrain& c : model.grain.classes) {
    j["grain_m"]["classes"][model.class_name(c.label)] = c.side_m;
  }
  if (!model.channels.empty()) j["channels"] = json_of(model.channels);
  const calibrate::GrainReport& grain = step.result.report.grain;
  if (grain.learnt()) {
    j["roughness_m"] = {
        {"log", grain.real_m}, {"simulated", grain.simulated_m}, {"simulated_anew", grain.anew_m}};
  }
  const calibrate::EchoGrainReport& echoes = step.result.report.echo_grain;
  if (echoes.learnt) {
    j["echoes_per_return"] = {{"log", echoes.real}, {"simulated", echoes.simulated}};
  }
  if (model.light.known()) j["light"] = json_of_light(model);
  if (model.keyframes) j["keyframes"] = json_of(*model.keyframes);
  j["skipped"] = step.skipped;
  j["warnings"] = r.warnings;
  if (!r.likelihood.steps.empty()) j["likelihood"] = json_of(r.likelihood);
  j["seconds"] = step.seconds;
  j["beams_per_s"] = double(r.beams) / step.seconds;
  return j;
}

}  // namespace underbrush::app
