#include "underbrush/fit/fit.hpp"

#include "underbrush/core/still_beams.hpp"
#include "underbrush/fit/fit_parts.hpp"
#include "underbrush/fit/part_options.hpp"

namespace underbrush::fit {
namespace {

FitResult fit_by_refinement(BeamSource& source, const FitOptions& options,
                            const FitProgress& progress) {
  FitResult out = start_of_refinement(source, options, progress);
  StillBeams still(source);
  take_refined(likelihood::refine(out.model, still, likelihood_options(options), progress,
                                  {.moving = {}, .open = out.open}),
               options, out);
  return out;
}

}  // namespace

FitResult fit(BeamSource& source, const FitOptions& given, const FitProgress& progress) {
  const Fitter& fitter = checked_fitter(given);
  FitBeams beams(source, given);
  const FitOptions options = with_measured_noise(given, beams);
  const ChannelOffsets channels = offsets_of(beams, options);
  CorrectedBeams corrected(beams.fitted, channels);
  FitResult out = fitter.refines ? fit_by_refinement(corrected, options, progress)
                                 : fitter.fit(corrected, options, progress);
  out.model.channels = channels;
  out.report.range_noise_m = options.range_noise_m;
  learn_all_but_geometry(beams, options, fitter, out);
  return out;
}

}  // namespace underbrush::fit
