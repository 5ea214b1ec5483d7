/// The result of a parameter search, as text, as JSON and as a configuration.
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "underbrush/optimize/search.hpp"
#include "underbrush/optimize/slice.hpp"

namespace underbrush::report {

/// A search that has ended.
struct Tuning {
  std::string log, objective, what;  ///< `what` is a sentence on the slice and its parts.
  std::vector<optimize::Parameter> parameters;
  std::vector<optimize::Evaluation> evaluations;  ///< The first is that of the start.
  nlohmann::ordered_json fixed =
      nlohmann::ordered_json::object();  ///< Options that were given and stay fixed, as NAME: VALUE
                                         ///< or [VALUES].
  bool densities = false;  ///< The parameters are densities of a scene's classes, for `compose`.
  std::string provenance;

  const optimize::Evaluation& start() const { return evaluations.front(); }
  const optimize::Evaluation& tuned() const { return evaluations[optimize::best_of(evaluations)]; }
};

/// Returns the sentence on a slice for `Tuning::what`. With `scene`, a scene is scored with all
/// beams of the slice.
std::string sentence_on(const optimize::SliceFacts& slice, const optimize::SliceOptions& cut,
                        bool scene);
/// Returns the search as JSON.
nlohmann::ordered_json json_of(const Tuning& tuning);
/// Returns a table of the parameters and scores before and after.
std::string text_of(const Tuning& tuning);
/// Returns one line on the last evaluation, with the best so far.
std::string line_of(const Tuning& tuning, std::span<const optimize::Evaluation> so_far,
                    size_t budget);
/// Writes the configuration for `fit --config` (with `densities`: for `compose --config`),
/// atomically.
void write_config(const std::filesystem::path& path, const Tuning& tuning);
/// Writes `folder`/index.html with the curve of the search, atomically, and returns its path.
std::filesystem::path write_tuning_report(const std::filesystem::path& folder,
                                          const Tuning& tuning);

}  // namespace underbrush::report
