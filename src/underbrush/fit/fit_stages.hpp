/// \file
/// A fit by refinement in stages that may run in processes of their own. Its result has the bits of
/// `fit`, however the passes over the beams are divided.
#pragma once
#include <vector>

#include "underbrush/fit/fit_options.hpp"
#include "underbrush/fit/fit_result.hpp"

namespace underbrush::fit {

/// The state of a fit before its refinement.
struct FitStart {
  FitResult fitted;  ///< The model that the refinement starts from, with the channels' offsets.
  std::vector<likelihood::ListedBeam> held_out;
  size_t training_beams = 0;
};

/// Takes the steps before the refinement: range offsets of the channels, and the start with its
/// leaf angles. The log is read several times. Throws as `fit` does, and `std::invalid_argument`
/// for a fitter that does not refine and for all echoes.
FitStart begin_fit(BeamSource& log, const FitOptions& options, const FitProgress& progress = {});

/// Begins the refinement. `info` is that of the log.
likelihood::Refinement begin_refinement(const FitStart& start, const LogInfo& info,
                                        const FitOptions& options);

/// Makes the pass that the next M-step needs over some rows of the log. Sums of all rows, added in
/// any order, are those of the whole. After the last M-step, the sums have no beams.
likelihood::PassSums sum_of_rows(BeamSource& rows, const likelihood::Refinement& refinement,
                                 const FitOptions& options, const FitProgress& progress = {});

/// Takes the M-steps that follow from the sums of all rows; none after the last M-step.
void take_step(likelihood::Refinement& refinement, likelihood::PassSums sums, const FitStart& start,
               const LogInfo& info, const FitOptions& options);

/// Ends a fit whose refinement has ended: corrects the densities, and learns the parts of the model
/// that a fit learns after the refinement. Returns what `fit` returns.
FitResult end_fit(BeamSource& log, FitStart start, likelihood::Refinement refinement,
                  const FitOptions& options);

}  // namespace underbrush::fit
