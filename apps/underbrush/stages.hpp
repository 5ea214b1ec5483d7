/// The steps of the main job as the verbs and the demo run them: files in, files out, with
/// progress.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "underbrush/elements/scene_file.hpp"
#include "underbrush/fit/fit.hpp"
#include "underbrush/metrics/score.hpp"
#include "underbrush/simulate/simulate.hpp"
#include "cli/verb.hpp"

namespace underbrush::app {

/// A scene's folder, or a model's as a scene without instances.
elements::Scene read_world(const std::filesystem::path& path, elements::SceneInfo* info = nullptr);
/// Its world. A model alone takes the shorter way, and gives the same bits as ever.
trace::World world_of(const elements::Scene& scene);

/// A fit; `skipped` counts records of the log left out, by reason.
struct FitStep {
  fit::FitResult result;
  std::map<std::string, size_t> skipped;
  double seconds = 0;
};
/// Fits a model to the log. With `likelihood`, `options.start` may also be a model's folder.
FitStep fit_log(const std::filesystem::path& log, const fit::FitOptions& options);
/// ... and writes it.
FitStep fit_log(const Verb& verb, const std::filesystem::path& log, const fit::FitOptions& options,
                const std::filesystem::path& model);

/// The steps of a refinement, for the manifest and `--json`.
Json json_of(const fit::LikelihoodReport& report);

/// Answers the beams and writes the log.
struct SimulateStep {
  size_t beams = 0, rows = 0, hits = 0;  ///< Rows: echoes and misses.
  double seconds_tracing = 0;
};
/// `write` is given the source, with progress, and the provenance.
using WriteLog = std::function<void(BeamSource&, const std::string& provenance)>;
SimulateStep simulate_log(const Verb& verb, simulate::SimulatedSource& simulated,
                          const WriteLog& write, const std::vector<std::filesystem::path>& inputs);
/// The beams of thin rays, written by the output's extension.
SimulateStep simulate_log(const Verb& verb, const trace::World& world, BeamSource& beams,
                          const simulate::Options& options, const std::filesystem::path& output,
                          const std::vector<std::filesystem::path>& inputs);

/// A simulated log to be scored, with the model that made it (or none).
struct Candidate {
  std::string name;
  std::filesystem::path log, model;  ///< `model` may be a scene.
};
/// Scores of each candidate against the real log.
std::vector<metrics::Score> score_logs(const std::filesystem::path& real,
                                       const std::vector<Candidate>& candidates, bool cloud);

/// Scores side by side, for people.
std::string table_of_scores(const std::vector<Candidate>& candidates,
                            const std::vector<metrics::Score>& scores);

/// Warnings, a line each.
std::string text_of_warnings(const std::vector<std::string>& warnings);

}  // namespace underbrush::app
