#include "fit_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/line.hpp"
#include "cli/progress.hpp"
#include "report/light_text.hpp"

namespace underbrush::app {
namespace {

std::string text_of_skipped(const pipeline::SkippedRows& skipped) {
  std::string text;
  for (const auto& [why, n] : skipped) text += line("skipped", "{} beams: {}", n, why);
  return text;
}

std::string text_of_grain(const elements::Model& model, const calibrate::GrainReport& grain) {
  std::string text;
  if (grain.learnt()) {
    text += fmt::format(
        "  grain       {:.3f} m of ellipsoids, {:.3f} m of meshes: {:.1f} cm rough along rings, "
        "the log {:.1f} cm\n",
        model.grain.ellipsoid_m, model.grain.mesh_m, 100 * grain.simulated_m, 100 * grain.real_m);
  }
  for (size_t k = 0; k < model.grain.classes.size(); ++k) {
    const elements::ClassGrain& c = model.grain.classes[k];
    text += fmt::format("              {:.3f} m of {}{}\n", c.side_m, model.class_name(c.label),
                        grain.classes[k] ? "" : ", the usual one: too few beams met it");
  }
  return text;
}

std::string text_of_sway(const elements::Model& model, const calibrate::SwayReport& sway) {
  if (!sway.stands) return "";
  if (!sway.known) return line("repeats", "too few to determine whether matter sways");
  return line("repeats", "differ by {:.1f} cm from scan to scan, {:.1f} if matter is still: {}",
              100 * sway.real_m, 100 * sway.still_m,
              model.sway_s > 0 ? fmt::format("it sways in {:.2g} s", model.sway_s) : "it is still");
}

}  // namespace

std::string text_of_channels(const ChannelOffsets& channels) {
  if (channels.empty()) return "";
  const OffsetSpread spread = spread_of(channels);
  return line("channels", "{} range offsets, sigma {:.1f} cm, standard error {:.1f} cm",
              channels.size(), 100 * spread.sigma_m, 100 * spread.standard_error_m);
}

std::string text_of_keyframes(const elements::Model& model) {
  if (!model.keyframes) return "";
  const nlohmann::ordered_json j = pipeline::json_of(*model.keyframes);
  std::string text = fmt::format("  keyframes   {} of {} x {} pixels, {:.1f} MB; weight",
                                 j["frames"].get<size_t>(), j["rows"].get<size_t>(),
                                 j["columns"].get<size_t>(), j["bytes"].get<double>() / 1e6);
  constexpr double kLeastWeight = 0.005;
  bool is_used = false;
  for (const nlohmann::ordered_json& d : j["trust"]) {
    const double agreed = d["where_ranges_agree"], differ = d["where_they_differ"];
    if (std::max(agreed, differ) < kLeastWeight) continue;
    is_used = true;
    text += fmt::format(" {:.0f} to {:.0f} % up to {:g} m,", 100 * std::min(agreed, differ),
                        100 * std::max(agreed, differ), d["up_to_m"].get<double>());
  }
  if (!is_used) return text + " below 1 %\n";
  text.back() = '\n';
  return text;
}

std::string text_of(const pipeline::FittedModel& fitted, const pipeline::SkippedRows& skipped) {
  const elements::Model& model = fitted.model;
  const fit::FitReport& r = fitted.report;
  std::string text = fmt::format(
      "{}: {} beams ({} hits, {} misses) in {:.1f} s, {} beams/s\n"
      "  ground      {} points, {} triangles, sigma {:.3f} m\n"
      "  other       {} points",
      model.fitter, r.beams, r.hits, r.misses, fitted.seconds, si(double(r.beams) / fitted.seconds),
      r.ground_points, model.ground.size(), model.ground.range_sigma_m, r.other_points);
  if (!model.ellipsoids.empty()) text += fmt::format(", {} ellipsoids", model.ellipsoids.size());
  if (model.surface.size()) text += fmt::format(", {} triangles", model.surface.size());
  if (r.unclustered_points) text += fmt::format(", {} in no cluster", r.unclustered_points);
  text += "\n" + text_of_channels(model.channels);
  if (r.free_space_ellipsoids) {
    text += line("dropped", "{} ellipsoids in free space", r.free_space_ellipsoids);
  }
  if (r.carved_triangles) {
    text += line("dropped", "{} triangles that beams passed", r.carved_triangles);
  }
  text += left_out(r.mover_points, "returns of movers") +
          left_out(r.near_points, "points near the sensor");
  if (r.thinned_points) text += line("left", "out    {} points of full tiles", r.thinned_points);
  if (r.sway.stands) {
    text += line("noise", "{:.1f} mm of the range, by repeated directions or --range-noise",
                 1e3 * r.range_noise_m);
  }
  text += text_of_grain(model, r.grain) + text_of_sway(model, r.sway) +
          report::text_of_light(model) + text_of_keyframes(model);
  if (r.echo_grain.learnt) {
    text += line("echoes", "{:.3f} of a beam that returns, the log {:.3f}", r.echo_grain.simulated,
                 r.echo_grain.real);
  }
  if (model.observed) {
    text += line("observed", "{} blocks of space, {:.1f} MB", model.observed->blocks.size(),
                 double(model.observed->bytes()) / 1e6);
  }
  text += text_of_skipped(skipped);
  for (const likelihood::LikelihoodStep& s : r.likelihood.steps) {
    const std::string training =
        s.training_nll ? fmt::format(" {:.4f} training,", *s.training_nll) : "";
    text += fmt::format("  {:<11} {} elements, -log f{} {:.4f} held out{}\n", s.name, s.elements,
                        training, s.held_out_nll, s.accepted ? "" : ", undone");
  }
  return text;
}

std::string text_of(const pipeline::UpdatedModel& updated, const pipeline::SkippedRows& skipped) {
  const update::UpdateReport& r = updated.report;
  std::string text = fmt::format(
      "{}: {} new beams ({} hits, {} misses) in {:.1f} s, {} earlier beams traced again\n"
      "  tiles       {} of {} touched, {} fitted anew\n"
      "  ellipsoids  {} kept, {} added, {} dropped\n",
      updated.model.fitter, r.beams, r.hits, r.misses, updated.seconds, r.earlier_beams,
      r.touched_tiles, r.tiles, r.fitted_tiles, r.kept, r.added, r.dropped);
  if (r.changed > 0) {
    text += fmt::format("  changed     {} ellipsoids, of which {} are gone", r.changed, r.gone);
    for (size_t k = 0; k < std::min<size_t>(3, r.places.size()); ++k) {
      const update::ChangedPlace& p = r.places[k];
      text += fmt::format("{} {} at {:.0f} {:.0f} {:.0f} m", k == 0 ? ":" : ",", p.gone,
                          p.centre.x(), p.centre.y(), p.centre.z());
    }
    text += "\n";
  }
  text += text_of_keyframes(updated.model);
  if (r.keyframes.kept > 0) {
    text += fmt::format("              {} kept and {} added; {} pixels of what changed forgotten\n",
                        r.keyframes.kept, r.keyframes.added, r.keyframes.forgotten_pixels);
  }
  return text + left_out(r.mover_points, "returns of movers") +
         left_out(r.near_points, "points near the sensor") + text_of_skipped(skipped);
}

}  // namespace underbrush::app
