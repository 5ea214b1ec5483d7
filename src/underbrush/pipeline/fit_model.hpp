/// \file
/// The verb `fit`: a log in, a model out, or a model and one more of its logs (`fit --update`).
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "underbrush/fit/training_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/sensor/sensor.hpp"
#include "underbrush/update/fit_log_options.hpp"

namespace underbrush::pipeline {

/// Returns the provenance of a result of these files and folders: a JSON object that has the hash
/// of each of them by its path under `inputs`.
using Provenance = std::function<std::string(const std::vector<std::filesystem::path>&)>;

/// A log that a model is made of.
struct FitLog {
  /// The log, with a row for each echo. A fit of first echoes takes only its grain from the others.
  BeamSource& beams;
  /// The file of the log, or those of a sequence (`io::LogSequence`). Empty for a log that is in no
  /// file.
  std::vector<std::filesystem::path> files = {};
};

/// A model and the other data of its folder.
struct TrainedModel {
  elements::Model model;
  /// The training, for updates. Its record has no tiles where the fitter cannot update its models,
  /// and it has no logs where the model's log is in no file.
  fit::Training training;
  std::filesystem::path folder;  ///< The folder that it was read from; empty for a new model.
  double seconds = 0;            ///< s; the time that `fit_model` or `update_model` took.
};

/// A model that was fitted to a log.
struct FittedModel : TrainedModel {
  fit::FitReport report;
};

/// A model to which a log was added.
struct UpdatedModel : TrainedModel {
  update::UpdateReport report;
};

/// Opens a log with a row for each beam (its first echo, or its miss), or with `all_echoes` with
/// all rows. Throws `FormatError`.
std::unique_ptr<io::LogReader> open_log(const std::filesystem::path& file, bool all_echoes);

/// Makes this the sensor that recorded the log, whose footprint some fitters remove.
void set_recorder(const sensor::Sensor& sensor, fit::FitOptions& options);

/// Fits a model to a log (`fit::fit`). Its provenance, to which the steps of a refinement are
/// added, is that of the log's files and of the folder of a model that `options.start` names;
/// without `provenance` the model has none and cannot be updated. Throws as `fit::fit` does, and
/// `FormatError` where that throws `DataError` on the log of a file.
FittedModel fit_model(const FitLog& log, const fit::FitOptions& options,
                      const Provenance& provenance = {}, const fit::FitProgress& progress = {});

/// Completes the result of a fit of `options` to a log as `fit_model` does.
FittedModel completed(fit::FitResult fitted, const FitLog& log, const fit::FitOptions& options,
                      const Provenance& provenance);

/// Adds a log to a model (`update::update`), whose parameters hold: `log` must have all echoes if
/// the model is one of all echoes. The earlier logs are read from their files. Throws as
/// `update::update` does, and `FormatError` for a model that cannot be updated, for an earlier log
/// that is not there or is another file, and for a log that the model has been fitted to already.
UpdatedModel update_model(TrainedModel known, const FitLog& log,
                          const update::FitLogOptions& options, const Provenance& provenance,
                          const fit::FitProgress& progress = {});

/// Reads the folder of a model, with its training where there is one. Throws `FormatError`.
TrainedModel read_trained(const std::filesystem::path& folder);

/// Writes the folder of a model with its training, as `elements::write_model` does.
void write_trained(const std::filesystem::path& folder, const TrainedModel& model);

}  // namespace underbrush::pipeline
