#include "underbrush/pipeline/fit_model.hpp"

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/fit/fitters.hpp"
#include "underbrush/fit/refinement_json.inl"
#include "underbrush/io/json_text.inl"

namespace underbrush::pipeline {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The files of a provenance, with their hashes.
class Origin {
 public:
  Origin(const Provenance& provenance, const std::vector<fs::path>& inputs)
      : json_(io::json_of_text(provenance(inputs))) {}
  std::string hash_of(const fs::path& file) const {
    return json_.at("inputs").at(file.string()).get<std::string>();
  }
  fit::TrainingLog training_log(const fs::path& file, bool all_echoes) const {
    return {file.string(), hash_of(file), open_log(file, all_echoes)->size()};
  }
  void add(const likelihood::LikelihoodReport& refinement) {
    if (!refinement.steps.empty()) json_["likelihood"] = fit::json_of(refinement);
  }
  std::string text() const { return io::text_of_json(json_); }

 private:
  Json json_;
};

/// The name of a log in messages: that of its first file, with the number of the others.
std::string name_of(const FitLog& log) {
  if (log.files.empty()) return "log";
  const size_t others = log.files.size() - 1;
  return log.files[0].string() + (others ? " and " + std::to_string(others) + " more" : "");
}

template <class Work>
auto on_log(const FitLog& log, const Work& work) {
  try {
    return work();
  } catch (const DataError& e) {
    if (log.files.empty()) throw;
    throw FormatError(name_of(log), "", e.what());
  }
}

/// Warns of a refinement that changed nothing, and of a grain that is not a number.
void warn_of_nothing_learnt(fit::FitReport& report) {
  size_t tried = 0, accepted = 0;
  for (const likelihood::LikelihoodStep& step : report.likelihood.steps) {
    if (step.name == "start") continue;
    ++tried;
    accepted += step.accepted;
  }
  constexpr size_t kFewBeams = 10000;
  if (tried > 0 && accepted == 0) {
    const bool few = report.likelihood.training_beams < kFewBeams;
    report.warnings.push_back(
        "every step of the fit was undone, because none made the held-out beams likelier: the "
        "model is that of its start (" +
        std::string(few ? "the log has few beams" : "check poses, ranges and misses of the log") +
        ")");
  }
  if (!std::isfinite(report.grain.real_m) || !std::isfinite(report.grain.simulated_m)) {
    report.warnings.push_back(
        "the roughness of the log is not a number, so no grain was learnt: no neighbouring beams "
        "returned within its ranges");
  }
}

/// Where an earlier log of a model is now.
fs::path place_of(const fit::TrainingLog& log, const fs::path& folder) {
  fs::path file = folder.empty() ? fs::path(log.file) : folder / fs::path(log.file).filename();
  if (fs::exists(file)) return file;
  throw FormatError(file.string(), "",
                    "the model was fitted to this log, which is not there; --logs FOLDER names "
                    "where it is now");
}

void check_training(const TrainedModel& known) {
  const auto fail = [&](const std::string& why) {
    throw FormatError(known.folder.empty() ? "model" : known.folder.string(), "", why);
  };
  if (known.training.record.tiles.empty()) {
    fail(
        "it cannot be updated: fit keeps what that needs in models of hierarchical, "
        "voxel, top_down, bottom_up, ground_mesh and likelihood, and this is one of " +
        known.model.fitter);
  }
  if (known.training.logs.empty()) {
    fail("it cannot be updated: the log that it was fitted to is in no file");
  }
  if (known.training.record.ellipsoids() != known.model.ellipsoids.size()) {
    fail("its training is that of another model");
  }
}

/// Puts the footprint of the recorder, which files do not have, into the options of a training.
void restore_recorder(TrainedModel& known) {
  fit::Training& training = known.training;
  if (!training.footprint || training.options.volumetric.mixture.footprint) return;
  LogInfo recorder;
  recorder.sensor = training.options.sensor;
  recorder.sensor_file = training.options.sensor_file;
  set_recorder(sensor::sensor_of_log(known.folder.string(), recorder), training.options);
}

/// Throws if the options name a sensor that has fewer channels than the one that the log names.
void check_recorder(const FitLog& log, const fit::FitOptions& options) {
  const LogInfo& info = log.beams.info();
  if (options.sensor.empty() || info.sensor.empty() || options.sensor == info.sensor) return;
  const std::string name = name_of(log);
  LogInfo given;
  given.sensor = options.sensor;
  given.sensor_file = options.sensor_file;
  if (sensor::sensor_of_log(name, info).channels.size() <=
      sensor::sensor_of_log(name, given).channels.size()) {
    return;
  }
  throw FormatError(name, "",
                    "it names its sensor, " + info.sensor + ", which has more channels than " +
                        options.sensor + " (--sensor)");
}

/// Throws unless the earlier logs are those of the training and the new one is none of them.
void check_hashes(const Origin& origin, const fit::Training& training,
                  const std::vector<fs::path>& files, const fs::path& added) {
  for (size_t k = 0; k < training.logs.size(); ++k) {
    const fit::TrainingLog& log = training.logs[k];
    if (origin.hash_of(files[k]) != log.hash) {
      throw FormatError(files[k].string(), "", "it is not the log that the model was fitted to");
    }
    if (!added.empty() && origin.hash_of(added) == log.hash) {
      throw FormatError(added.string(), "", "the model has been fitted to this log already");
    }
  }
}

}  // namespace

std::unique_ptr<io::LogReader> open_log(const fs::path& file, bool all_echoes) {
  if (all_echoes) return std::make_unique<io::LogReader>(file);
  return std::make_unique<io::BeamReader>(file);
}

void set_recorder(const sensor::Sensor& sensor, fit::FitOptions& options) {
  options.sensor = sensor.name;
  options.sensor_file = sensor.file;
  options.volumetric.mixture.footprint = [beam = sensor.beam](double range_m) {
    return beam.sigma_m(range_m);
  };
}

FittedModel fit_model(const FitLog& log, const fit::FitOptions& options,
                      const Provenance& provenance, const fit::FitProgress& progress) {
  check_recorder(log, options);
  const auto start = Clock::now();
  FittedModel out = completed(on_log(log, [&] { return fit::fit(log.beams, options, progress); }),
                              log, options, provenance);
  out.seconds = seconds_since(start);
  return out;
}

FittedModel completed(fit::FitResult fitted, const FitLog& log, const fit::FitOptions& options,
                      const Provenance& provenance) {
  FittedModel out;
  out.model = std::move(fitted.model);
  out.report = std::move(fitted.report);
  warn_of_nothing_learnt(out.report);
  out.training = {
      options, bool(options.volumetric.mixture.footprint), {}, std::move(fitted.record)};
  out.training.options.range_noise_m = out.report.range_noise_m;
  if (provenance) {
    std::vector<fs::path> inputs = log.files;
    if (fit::fitter_named(options.fitter).refines && elements::is_model(options.start)) {
      inputs.emplace_back(options.start);
    }
    Origin origin(provenance, inputs);
    origin.add(out.report.likelihood);
    out.model.provenance = origin.text();
    for (const fs::path& file : log.files) {
      out.training.logs.push_back(origin.training_log(file, options.all_echoes));
    }
  }
  return out;
}

UpdatedModel update_model(TrainedModel known, const FitLog& log,
                          const update::FitLogOptions& options, const Provenance& provenance,
                          const fit::FitProgress& progress) {
  const auto start = Clock::now();
  require(log.files.size() <= 1, "update: logs are added one after another");
  const fs::path file = log.files.empty() ? fs::path() : log.files[0];
  check_training(known);
  restore_recorder(known);
  fit::Training& training = known.training;
  std::vector<fs::path> inputs;
  for (const fit::TrainingLog& earlier : training.logs) {
    inputs.push_back(place_of(earlier, options.logs));
  }
  std::vector<std::unique_ptr<io::LogReader>> readers;
  std::vector<BeamSource*> earlier;
  for (const fs::path& input : inputs) {
    readers.push_back(open_log(input, known.model.all_echoes));
    earlier.push_back(readers.back().get());
  }
  if (!file.empty()) inputs.push_back(file);
  if (!known.folder.empty()) inputs.push_back(known.folder);
  const Origin origin(provenance, inputs);
  check_hashes(origin, training, inputs, file);
  fit::FitResult before;
  before.model = std::move(known.model);
  before.record = std::move(training.record);
  update::UpdateResult grown = on_log(log, [&] {
    return update::update(std::move(before), earlier, log.beams, training.options, options.update,
                          progress);
  });
  UpdatedModel out;
  out.model = std::move(grown.model);
  out.model.provenance = origin.text();
  out.report = std::move(grown.report);
  out.training = std::move(training);
  out.training.record = std::move(grown.record);
  if (log.beams.size() > 0) {
    // A model of a log that is in no file cannot be updated again.
    if (file.empty()) {
      out.training.logs.clear();
    } else {
      out.training.logs.push_back(origin.training_log(file, known.model.all_echoes));
    }
  }
  out.seconds = seconds_since(start);
  return out;
}

TrainedModel read_trained(const fs::path& folder) {
  TrainedModel out;
  out.folder = folder;
  out.model = elements::read_model(folder);
  if (fit::has_training(folder)) out.training = fit::read_training(folder);
  return out;
}

void write_trained(const fs::path& folder, const TrainedModel& model) {
  elements::write_model(folder, model.model, [&](const fs::path& written) {
    if (model.training.record.tiles.empty() || model.training.logs.empty()) return;
    fit::write_training(written, model.training);
  });
}

}  // namespace underbrush::pipeline
