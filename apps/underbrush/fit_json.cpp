#include "fit_json.hpp"

#include <fmt/format.h>

#include "light_report.hpp"

namespace underbrush::app {

Json json_of(const fit::LikelihoodReport& report) {
  Json j;
  j["training_beams"] = report.training_beams;
  j["held_out_beams"] = report.held_out_beams;
  j["stray_hits"] = report.stray_hits;
  for (const fit::LikelihoodStep& s : report.steps) {
    j["steps"].push_back({{"name", s.name},
                          {"elements", s.elements},
                          {"training_nll", s.training_nll},
                          {"held_out_nll", s.held_out_nll},
                          {"accepted", s.accepted}});
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
  if (step.grain.learnt()) {
    j["roughness_m"] = {{"log", step.grain.real_m},
                        {"simulated", step.grain.simulated_m},
                        {"simulated_anew", step.grain.anew_m}};
  }
  if (step.echoes.learnt) {
    j["echoes_per_return"] = {{"log", step.echoes.real}, {"simulated", step.echoes.simulated}};
  }
  if (model.light.known()) j["light"] = json_of_light(model);
  j["skipped"] = step.skipped;
  j["warnings"] = r.warnings;
  if (!r.likelihood.steps.empty()) j["likelihood"] = json_of(r.likelihood);
  j["seconds"] = step.seconds;
  j["beams_per_s"] = double(r.beams) / step.seconds;
  return j;
}

}  // namespace underbrush::app
