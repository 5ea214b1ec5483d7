/// The stages of the pipeline as the verbs and the demo run them: files in, files out, with
/// progress.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "cli/verb.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/fit/fit.hpp"
#include "underbrush/metrics/baselines.hpp"
#include "underbrush/simulate/simulate.hpp"
#include "underbrush/worlds/read_world.hpp"

namespace underbrush::app {

/// Reads a scene, a model as a scene without instances, or a world in a third-party format, such as
/// a mesh. `info` receives what the scene's folder holds besides; `report` what a third-party file
/// became, where `parts` stays 0 for all others.
elements::Scene read_world(const std::filesystem::path& path, elements::SceneInfo* info = nullptr,
                           const worlds::ReadOptions& options = {},
                           worlds::WorldReport* report = nullptr);
/// Returns the world of a scene. Without instances it is the world of the scene's model, to the
/// bit.
trace::World world_of(const elements::Scene& scene, trace::Draws draws = trace::Draws::kAnew);

/// A fit, with the number of records of the log left out by reason.
struct FitStep {
  fit::FitResult result;
  std::map<std::string, size_t> skipped;
  double seconds = 0;
};
/// Fits a model to the log and writes it to the folder `model`. For the fitter `likelihood`,
/// `options.start` may also be a model's folder.
FitStep fit_log(const Verb& verb, const std::filesystem::path& log, const fit::FitOptions& options,
                const std::filesystem::path& model);

/// Counts of a simulated log.
struct SimulateStep {
  size_t beams = 0, rows = 0, hits = 0;  ///< Rows are echoes and misses.
  double seconds_tracing = 0;
};
/// Writes a log from the source that it is given, with the provenance.
using WriteLog = std::function<void(BeamSource&, const std::string& provenance)>;
/// Simulates the beams and writes the log by `write`, with progress.
SimulateStep simulate_log(const Verb& verb, simulate::SimulatedSource& simulated,
                          const WriteLog& write, const std::vector<std::filesystem::path>& inputs);
/// Simulates beams as thin rays and writes the log in the format of the output's extension.
SimulateStep simulate_log(const Verb& verb, const trace::World& world, BeamSource& beams,
                          const simulate::Options& options, const std::filesystem::path& output,
                          const std::vector<std::filesystem::path>& inputs);

/// A simulated log to be scored, and the model that made it (or none).
struct Candidate {
  std::string name;
  std::filesystem::path log, model;  ///< `model` may be a scene.
};
/// Scores each candidate against the real log.
std::vector<metrics::Score> score_logs(const std::filesystem::path& real,
                                       const std::vector<Candidate>& candidates, bool cloud);

/// Scores the baselines on the beams of the real log; `train` may be empty.
std::vector<metrics::Baseline> score_baselines(const std::filesystem::path& real,
                                               const std::filesystem::path& train);

/// Returns the scores of candidates and of baselines side by side as text.
std::string table_of_scores(const std::vector<Candidate>& candidates,
                            const std::vector<metrics::Score>& scores,
                            const std::vector<metrics::Baseline>& baselines);

/// Returns the warnings, one on each line.
std::string text_of_warnings(const std::vector<std::string>& warnings);

}  // namespace underbrush::app
