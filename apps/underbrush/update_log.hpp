/// \file
/// The stage that adds a log to a model: files in, a model's folder out.
#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "cli/verb.hpp"
#include "underbrush/fit/training_file.hpp"
#include "underbrush/update/update.hpp"

namespace underbrush::app {

/// What to add to which model.
struct UpdateInput {
  std::filesystem::path model, log;
  /// The folder where the logs of the model are now; empty: where they were.
  std::filesystem::path logs;
  update::UpdateOptions how;
};

/// An update, with the number of records of the log left out by reason.
struct UpdateStep {
  update::UpdateResult result;
  std::map<std::string, size_t> skipped;
  size_t logs = 0;  ///< The logs of the model, the new one included.
  double seconds = 0;
};

/// Adds a log to a model and writes the result to the folder `output`, with its training. Throws
/// `FormatError` for a model that cannot be updated and for a log of it that is not there or is
/// another file.
UpdateStep update_log(const Verb& verb, const UpdateInput& input,
                      const std::filesystem::path& output);

/// The training of a model that was fitted to one log, for its folder. `hash` is that of the log.
fit::Training training_of(const fit::FitResult& fitted, const fit::FitOptions& options,
                          const std::filesystem::path& log, const std::string& hash, size_t beams);

/// Returns the counts, warnings and times of an update.
Json json_of(const UpdateStep& step);
/// The same as text.
std::string text_of(const UpdateStep& step);

}  // namespace underbrush::app
