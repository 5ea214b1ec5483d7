#include "underbrush/jobs/fit_stage.hpp"

#include <chrono>

#include "underbrush/core/check.hpp"
#include "underbrush/fit/stage_files.hpp"

namespace underbrush::jobs {
namespace {

/// The rows of sum:FIRST:END.
std::pair<size_t, size_t> rows_of(const std::string& stage) {
  size_t first = 0, end = 0;
  int read = 0;
  require(std::sscanf(stage.c_str(), "sum:%zu:%zu%n", &first, &end, &read) == 2 &&
              size_t(read) == stage.size() && first < end,
          "fit: the stages are begin, sum:FIRST:END, step and end");
  return {first, end};
}

void begin(io::LogSequence& log, const fit::FitOptions& options, const std::string& output,
           const fit::FitProgress& progress) {
  const fit::FitStart start = fit::begin_fit(log, options, progress);
  fit::write_start(output, start, fit::begin_refinement(start, log.info(), options), options);
}

void sum(const FitStage& stage, io::LogSequence& log, const fit::FitOptions& options,
         const std::string& output, const fit::FitProgress& progress) {
  require(stage.from.size() == 1, "fit: a sum is from one folder");
  const auto [first, end] = rows_of(stage.name);
  log.keep_rows(first, end);
  const likelihood::Refinement refinement = fit::read_refinement(stage.from[0]);
  fit::write_sums(output, fit::sum_of_rows(log, refinement, options, progress));
}

/// Adds the sums that the stages before have left.
likelihood::PassSums sums_of(const FitStage& stage, const elements::Model& model) {
  likelihood::PassSums sums{likelihood::ElementSums(model), {}, 0};
  for (size_t k = 2; k < stage.from.size(); ++k) fit::add_sums(stage.from[k], sums);
  return sums;
}

/// Takes the step of the sums. What they make of the model is wrong where they are.
void take_step(const FitStage& stage, likelihood::Refinement& refinement,
               const fit::FitStart& start, const LogInfo& info, const fit::FitOptions& options) {
  try {
    fit::take_step(refinement, sums_of(stage, refinement.best->model), start, info, options);
    refinement.best->model.check();
  } catch (const std::invalid_argument& e) {
    throw FormatError(stage.from.back(), "", std::string("its sums do not fit: ") + e.what());
  }
}

}  // namespace

std::optional<pipeline::FittedModel> run_fit_stage(const FitStage& stage, io::LogSequence& logs,
                                                   const fit::FitOptions& options,
                                                   const std::string& output,
                                                   const pipeline::Provenance& provenance,
                                                   const fit::FitProgress& progress) {
  const auto begin_time = std::chrono::steady_clock::now();
  if (stage.name == "begin") {
    begin(logs, options, output, progress);
    return {};
  }
  if (stage.name != "step" && stage.name != "end") {
    sum(stage, logs, options, output, progress);
    return {};
  }
  require(stage.from.size() >= 2, "fit: a step is from two folders and the files of sums");
  fit::FitStart start = fit::read_start(stage.from[0]);
  likelihood::Refinement refinement = fit::read_refinement(stage.from[1]);
  take_step(stage, refinement, start, logs.info(), options);
  if (stage.name == "step") {
    fit::write_refinement(output, refinement);
    return {};
  }
  pipeline::FittedModel out =
      pipeline::completed(fit::end_fit(logs, std::move(start), std::move(refinement), options),
                          {logs, logs.files()}, options, provenance);
  out.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_time).count();
  return out;
}

}  // namespace underbrush::jobs
