#include "underbrush/pipeline/kept_search.hpp"

#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/io/hash.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/optimize/checkpoint.hpp"

namespace underbrush::pipeline {
namespace {

using Json = nlohmann::ordered_json;

/// A text of all that determines the results of a search, except its budget.
std::string identity_of(const TuningProblem& problem, const optimize::TuneOptions& options,
                        const SearchFile& file) {
  Json run;
  run["objective"] = options.objective;
  run["algorithm"] = options.search.algorithm;
  run["step"] = options.search.step;
  run["slice"] = options.slice;
  run["validate"] = options.validate;
  run["seed"] = options.seed;
  for (size_t k = 0; k < problem.start.size(); ++k) {
    const optimize::Parameter& q = problem.parameters[k];
    run["parameters"].push_back({q.name, q.low, q.high, int(q.scale), problem.start[k]});
  }
  run["fixed"] = io::json_of_text(file.fixed);
  const std::filesystem::path sensor = run["fixed"].value("sensor", "");
  if (std::filesystem::is_regular_file(sensor)) run["sensor"] = io::hash_of(sensor);
  run["program"] = file.program;
  run["inputs"] = file.inputs;
  return io::text_of_json(run);
}

/// The evaluations from which the search goes on.
std::vector<optimize::Evaluation> past_of(const SearchFile& file, const std::string& identity) {
  if (!std::filesystem::exists(file.path)) return {};
  const optimize::Checkpoint found = optimize::read_checkpoint(file.path);
  if (!file.resume) {
    if (found.finished) return {};
    throw std::invalid_argument(
        "optimize: " + printable(file.path.string()) + " holds " +
        std::to_string(found.evaluations.size()) +
        " evaluations of a search that did not end; give --resume (in Python "
        "resume=True) to go on, or remove it");
  }
  if (io::json_of_text(found.run) != io::json_of_text(identity)) {
    throw FormatError(file.path.string(), "",
                      "it is of another search (log, options or seed differ)");
  }
  return found.evaluations;
}

}  // namespace

KeptSearch tune_and_keep(const TuningProblem& problem, const optimize::TuneOptions& options,
                         const SearchFile& file,
                         const std::function<void(std::span<const optimize::Evaluation>)>& after) {
  optimize::Checkpoint kept{identity_of(problem, options, file), false, {}};
  const std::vector<optimize::Evaluation> past = past_of(file, kept.run);
  KeptSearch out{{}, past.size()};
  try {
    out.evaluations =
        tune(problem, options, past, [&](std::span<const optimize::Evaluation> so_far) {
          kept.evaluations.assign(so_far.begin(), so_far.end());
          optimize::write_checkpoint(file.path, kept);
          if (after) after(so_far);
        });
  } catch (const DataError& e) {
    if (past.empty()) throw;
    throw FormatError(file.path.string(), "", e.what());
  }
  kept.evaluations = out.evaluations;
  optimize::write_checkpoint(file.path, kept);
  return out;
}

void end_search(const SearchFile& file) {
  optimize::Checkpoint kept = optimize::read_checkpoint(file.path);
  kept.finished = true;
  optimize::write_checkpoint(file.path, kept);
}

}  // namespace underbrush::pipeline
