#include "update_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "cli/progress.hpp"
#include "fit_json.hpp"
#include "fit_options.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/io/log_file.hpp"

namespace underbrush::app {
namespace fs = std::filesystem;
namespace {

std::unique_ptr<io::LogReader> reader_of(const fs::path& log, bool all_echoes) {
  if (all_echoes) return std::make_unique<io::LogReader>(log);
  return std::make_unique<io::BeamReader>(log);
}

fit::Training training_of(const UpdateInput& input, const elements::Model& model) {
  if (!fit::has_training(input.model)) {
    throw FormatError(
        input.model.string(), "",
        "it cannot be updated: fit keeps what that needs in models of hierarchical, "
        "voxel, top_down, bottom_up, ground_mesh and likelihood, and this is one of " +
            model.fitter);
  }
  fit::Training training = fit::read_training(input.model);
  if (training.record.ellipsoids() != model.ellipsoids.size()) {
    throw FormatError(input.model.string(), "", "its training is that of another model");
  }
  if (training.footprint) {
    LogInfo recorder;
    recorder.sensor = training.options.sensor;
    recorder.sensor_file = training.options.sensor_file;
    set_recorder(sensor::sensor_of_log(input.model.string(), recorder), training.options);
  }
  return training;
}

/// Where a log of the model is now.
fs::path place_of(const fit::TrainingLog& log, const fs::path& folder) {
  const fs::path file =
      folder.empty() ? fs::path(log.file) : folder / fs::path(log.file).filename();
  if (fs::exists(file)) return file;
  throw FormatError(file.string(), "",
                    "the model was fitted to this log, which is not there; --logs FOLDER names "
                    "where it is now");
}

std::string hash_in(const Json& provenance, const fs::path& file) {
  return provenance.at("inputs").at(file.string()).get<std::string>();
}

}  // namespace

fit::Training training_of(const fit::FitResult& fitted, const fit::FitOptions& options,
                          const fs::path& log, const std::string& hash, size_t beams) {
  fit::Training out{options, bool(options.volumetric.mixture.footprint), {}, fitted.record};
  out.logs.push_back({log.string(), hash, beams});
  return out;
}

UpdateStep update_log(const Verb& verb, const UpdateInput& input, const fs::path& output) {
  const auto start = std::chrono::steady_clock::now();
  elements::check_model_output(output);
  fit::FitResult known;
  known.model = elements::read_model(input.model);
  fit::Training training = training_of(input, known.model);
  std::vector<fs::path> inputs;
  for (const fit::TrainingLog& log : training.logs) inputs.push_back(place_of(log, input.logs));
  const bool all_echoes = known.model.all_echoes;
  std::vector<std::unique_ptr<io::LogReader>> readers;
  std::vector<BeamSource*> logs;
  for (const fs::path& log : inputs) {
    readers.push_back(reader_of(log, all_echoes));
    logs.push_back(readers.back().get());
  }
  const auto added = reader_of(input.log, all_echoes);
  inputs.push_back(input.log);
  inputs.push_back(input.model);
  const std::string text = provenance(verb, inputs);
  const Json origin = io::json_of_text(text);
  for (size_t k = 0; k < training.logs.size(); ++k) {
    const fit::TrainingLog& log = training.logs[k];
    if (hash_in(origin, inputs[k]) != log.hash) {
      throw FormatError(inputs[k].string(), "", "it is not the log that the model was fitted to");
    }
    if (hash_in(origin, input.log) == log.hash) {
      throw FormatError(input.log.string(), "", "the model has been fitted to this log already");
    }
  }
  known.record = std::move(training.record);
  UpdateStep step;
  {
    StageProgress progress;
    step.result = update::update(std::move(known), logs, *added, training.options, input.how,
                                 std::ref(progress));
  }
  step.skipped = added->skipped();
  if (added->size() > 0) {
    training.logs.push_back({input.log.string(), hash_in(origin, input.log), added->size()});
  }
  step.logs = training.logs.size();
  training.record = step.result.record;
  step.result.model.provenance = text;
  elements::write_model(output, step.result.model,
                        [&](const fs::path& folder) { fit::write_training(folder, training); });
  step.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return step;
}

Json json_of(const UpdateStep& step) {
  const update::UpdateReport& r = step.result.report;
  Json j;
  j["fitter"] = step.result.model.fitter;
  j["beams"] = r.beams;
  j["hits"] = r.hits;
  j["misses"] = r.misses;
  if (r.mover_points > 0) j["mover_points"] = r.mover_points;
  j["near_points"] = r.near_points;
  j["unexplained"] = r.unexplained;
  j["earlier_beams"] = r.earlier_beams;
  j["logs"] = step.logs;
  j["tiles"] = {{"all", r.tiles}, {"touched", r.touched_tiles}, {"fitted_anew", r.fitted_tiles}};
  j["ellipsoids"] = {{"all", step.result.model.ellipsoids.size()},
                     {"kept", r.kept},
                     {"added", r.added},
                     {"dropped", r.dropped},
                     {"changed", r.changed},
                     {"gone", r.gone}};
  j["gone"] = Json::array();
  for (const update::ChangedPlace& p : r.places) {
    j["gone"].push_back(
        {{"centre_m", {p.centre.x(), p.centre.y(), p.centre.z()}}, {"ellipsoids", p.gone}});
  }
  j["ground_triangles"] = step.result.model.ground.size();
  if (step.result.model.keyframes) {
    j["keyframes"] = json_of(*step.result.model.keyframes);
    j["keyframes"]["kept"] = r.keyframes.kept;
    j["keyframes"]["added"] = r.keyframes.added;
    j["keyframes"]["forgotten_pixels"] = r.keyframes.forgotten_pixels;
  }
  j["skipped"] = step.skipped;
  j["warnings"] = r.warnings;
  j["seconds"] = step.seconds;
  return j;
}

std::string text_of(const UpdateStep& step) {
  const update::UpdateReport& r = step.result.report;
  std::string text = fmt::format(
      "{}: {} new beams ({} hits, {} misses) in {:.1f} s, {} earlier beams traced again\n"
      "  tiles       {} of {} touched, {} fitted anew\n"
      "  ellipsoids  {} kept, {} added, {} dropped\n",
      step.result.model.fitter, r.beams, r.hits, r.misses, step.seconds, r.earlier_beams,
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
  text += text_of_keyframes(step.result.model);
  if (r.keyframes.kept > 0) {
    text += fmt::format("              {} kept and {} added; {} pixels of what changed forgotten\n",
                        r.keyframes.kept, r.keyframes.added, r.keyframes.forgotten_pixels);
  }
  if (r.mover_points) text += fmt::format("  left out    {} returns of movers\n", r.mover_points);
  if (r.near_points)
    text += fmt::format("  left out    {} points near the sensor\n", r.near_points);
  for (const auto& [why, n] : step.skipped) {
    text += fmt::format("  skipped     {} beams: {}\n", n, why);
  }
  return text;
}

}  // namespace underbrush::app
