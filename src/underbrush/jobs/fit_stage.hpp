/// \file
/// The stages of a fit as tasks, each a process of its own.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/io/log_sequence.hpp"
#include "underbrush/jobs/job.hpp"
#include "underbrush/pipeline/fit_model.hpp"

namespace underbrush::jobs {

/// A stage of a fit by refinement, and the outputs of the stages before it.
struct FitStage {
  /// One of
  /// - `begin`, all that comes before the refinement;
  /// - `sum:FIRST:END`, the sums that the next M-step needs of these rows of the log;
  /// - `step`, the M-step of these sums;
  /// - `end`, the last M-step and all that follows.
  std::string name;
  /// For `sum`, the folder of the last `step` or of `begin`; for `step` and `end`, the folder of
  /// `begin`, that of the last `step` or of `begin`, and the files of all sums.
  std::vector<std::string> from;
};

/// Runs a stage of the fit of a model to logs. `end` returns the model, the others write their
/// results to `output`. The model has the bits of `pipeline::fit_model`. Throws as that does, and
/// `std::invalid_argument` for a stage that is not one.
std::optional<pipeline::FittedModel> run_fit_stage(const FitStage& stage, io::LogSequence& logs,
                                                   const fit::FitOptions& options,
                                                   const std::string& output,
                                                   const pipeline::Provenance& provenance,
                                                   const fit::FitProgress& progress = {});

}  // namespace underbrush::jobs
