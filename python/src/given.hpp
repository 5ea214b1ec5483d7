/// \file
/// Values or paths that Python gives, opened for the library.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/fit/training_file.hpp"

namespace underbrush::python {

/// A model with the report of the fit that made it, and with the training for updates of it.
struct ModelValue : elements::Model {
  fit::Training training = {};
  std::string report = "{}";  ///< JSON.
};

/// A scene with the other contents of its folder.
struct SceneValue {
  elements::Scene scene;
  elements::SceneInfo info;
  std::string report = "{}";  ///< JSON of the composition that made it.
};

using GivenLog = std::variant<std::filesystem::path, const BeamLog*>;
using GivenModel = std::variant<std::filesystem::path, const ModelValue*>;
using GivenWorld = std::variant<std::filesystem::path, const ModelValue*, const SceneValue*>;

/// Returns a source of the log's beams: a row for each beam (its first echo, or its miss), or with
/// `echoes` every row. A log in memory must outlive the source.
std::unique_ptr<BeamSource> source_of(const GivenLog& log, bool echoes = false);

/// Reads the rest of a source into one log.
BeamLog whole_log(BeamSource& source);

/// Joins the chunks of a log, each of which is freed once it is copied.
BeamLog joined(std::vector<BeamLog> chunks);

/// Returns how many records of the source were left out so far, by reason.
std::map<std::string, size_t> skipped_in(const BeamSource& source);

/// Returns the path of a log, or "log" for one in memory, for messages.
std::string name_of(const GivenLog& log);

/// Calls `work`, and lets a `DataError` name the file of the log, where it has one.
template <class Work>
auto with_name(const GivenLog& log, Work work) {
  try {
    return work();
  } catch (const DataError& e) {
    if (!std::holds_alternative<std::filesystem::path>(log)) throw;
    throw FormatError(name_of(log), "", e.what());
  }
}

/// Returns the model: the value itself, or the one that is read into `read`.
const elements::Model& model_of(const GivenModel& model, elements::Model& read);

}  // namespace underbrush::python
