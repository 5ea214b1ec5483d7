#include "underbrush/fit/fit_stages.hpp"

#include "underbrush/core/check.hpp"
#include "underbrush/core/still_beams.hpp"
#include "underbrush/fit/fit_parts.hpp"
#include "underbrush/fit/gather.hpp"
#include "underbrush/fit/part_options.hpp"

namespace underbrush::fit {
namespace {

/// The options with the range noise that the start of the fit found.
FitOptions noted(FitOptions options, const FitStart& start) {
  options.range_noise_m = start.fitted.report.range_noise_m;
  return options;
}

likelihood::Refiner refiner(const FitStart& start, const likelihood::ListedBeams& beams,
                            const likelihood::LikelihoodOptions& options) {
  return {start.fitted.model, beams, options, {.moving = {}, .open = start.fitted.open}};
}

}  // namespace

FitStart begin_fit(BeamSource& log, const FitOptions& given, const FitProgress& progress) {
  require(checked_fitter(given).refines && !given.all_echoes,
          "fit: only fits by likelihood, of first echoes, have stages");
  FitBeams beams(log, given);
  const FitOptions options = with_measured_noise(given, beams);
  const ChannelOffsets channels = offsets_of(beams, options);
  CorrectedBeams corrected(beams.fitted, channels);
  FitStart out;
  out.fitted = start_of_refinement(corrected, options, progress);
  out.fitted.model.channels = channels;
  out.fitted.report.range_noise_m = options.range_noise_m;
  StillBeams still(corrected);
  const likelihood::ListedBeams listed(still, likelihood_options(options).held_out,
                                       out.fitted.model, 0);
  out.held_out = listed.held_out();
  out.training_beams = listed.training_beams();
  return out;
}

likelihood::Refinement begin_refinement(const FitStart& start, const LogInfo& info,
                                        const FitOptions& options) {
  const likelihood::LikelihoodOptions refinement_options =
      likelihood_options(noted(options, start));
  const likelihood::ListedBeams beams(info, start.held_out, start.training_beams);
  return refiner(start, beams, refinement_options).begin();
}

likelihood::PassSums sum_of_rows(BeamSource& rows, const likelihood::Refinement& refinement,
                                 const FitOptions& options, const FitProgress& progress) {
  const likelihood::LikelihoodOptions refinement_options = likelihood_options(options);
  const elements::Model& model = refinement.best->model;
  const auto share = refinement.wanted(refinement_options);
  if (!share) return {likelihood::ElementSums(model), {}, 0};
  FirstEchoes first(rows);
  CorrectedBeams corrected(first, model.channels);
  StillBeams still(corrected);
  const likelihood::ListedBeams beams(still, refinement_options.held_out, model,
                                      likelihood::kListBytes);
  return likelihood::pass_over_training(refinement.best->world, beams, *share, refinement.soft,
                                        stage_of(progress, "sum"));
}

void take_step(likelihood::Refinement& refinement, likelihood::PassSums sums, const FitStart& start,
               const LogInfo& info, const FitOptions& options) {
  const likelihood::LikelihoodOptions refinement_options =
      likelihood_options(noted(options, start));
  const auto share = refinement.wanted(refinement_options);
  if (!share) return;
  const likelihood::ListedBeams beams(info, start.held_out, start.training_beams);
  refiner(start, beams, refinement_options)
      .maximise(refinement, likelihood::expectation_of(std::move(sums), *share));
}

FitResult end_fit(BeamSource& log, FitStart start, likelihood::Refinement refinement,
                  const FitOptions& given) {
  const Fitter& fitter = checked_fitter(given);
  const FitOptions options = noted(given, start);
  const likelihood::LikelihoodOptions refinement_options = likelihood_options(options);
  require(!refinement.wanted(refinement_options), "fit: the refinement is not at its end");
  const likelihood::ListedBeams held_out(log.info(), std::move(start.held_out),
                                         start.training_beams);
  likelihood::Refined refined =
      refiner(start, held_out, refinement_options).finish(std::move(refinement));
  FitResult out = std::move(start.fitted);
  const ChannelOffsets channels = out.model.channels;
  take_refined(std::move(refined), options, out);
  out.model.channels = channels;
  FitBeams beams(log, options);
  learn_all_but_geometry(beams, options, fitter, out);
  return out;
}

}  // namespace underbrush::fit
