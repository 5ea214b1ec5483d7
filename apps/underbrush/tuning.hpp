/// What came of a search for parameters: for people, for programs, and as a configuration.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/optimize/search.hpp"
#include "cli/verb.hpp"

namespace underbrush::app {

/// A search that has ended.
struct Tuning {
  std::string log, objective, what;  ///< `what`: one sentence on slice and parts.
  std::vector<optimize::Parameter> parameters;
  std::vector<optimize::Evaluation> evaluations;  ///< The first is the start.
  Json fixed = Json::object();  ///< Options that were given and stay: NAME: VALUE or [VALUES].
  bool densities = false;       ///< Parameters are classes of a scene, for `compose`.
  std::string provenance;

  const optimize::Evaluation& start() const { return evaluations.front(); }
  const optimize::Evaluation& tuned() const { return evaluations[optimize::best_of(evaluations)]; }
};

Json json_of(const Tuning& tuning);
/// A table of the parameters and scores, before and after.
std::string text_of(const Tuning& tuning);
/// One line on an evaluation, with the best so far.
std::string line_of(const Tuning& tuning, std::span<const optimize::Evaluation> so_far,
                    size_t budget);
/// Writes the file that `fit --config` takes (with `densities`: `compose --config`), atomically.
void write_config(const std::filesystem::path& path, const Tuning& tuning);
/// Writes `folder`/index.html, atomically, with the curve; returns its path.
std::filesystem::path write_tuning_report(const std::filesystem::path& folder,
                                          const Tuning& tuning);

}  // namespace underbrush::app
