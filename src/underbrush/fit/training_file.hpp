/// \file
/// The training of a model on disk: the parameters of the fit, its logs and its tiles, in the
/// folder `training` of the model. Layout: docs/reference/formats.md.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/fit/fit_options.hpp"
#include "underbrush/fit/fit_result.hpp"

namespace underbrush::fit {

/// A log that a model was fitted to.
struct TrainingLog {
  std::string file;  ///< The path that the caller gave.
  std::string hash;
  uint64_t beams = 0;
};

/// The data on the making of a model that `update` needs.
struct Training {
  /// The parameters (`parameters`), the seed and the recorder; the footprint is not in it.
  FitOptions options;
  bool footprint = false;  ///< Whether the footprint of the recorder was removed.
  std::vector<TrainingLog> logs;
  FitRecord record;
};

/// Writes the training of a model into its folder, for the `besides` of `elements::write_model`.
/// Throws `IoError`.
void write_training(const std::filesystem::path& model, const Training& training);

/// Whether a model's folder keeps its training.
bool has_training(const std::filesystem::path& model);

/// Reads the training of a model. Throws `FormatError` for one that is not whole and consistent.
Training read_training(const std::filesystem::path& model);

}  // namespace underbrush::fit
