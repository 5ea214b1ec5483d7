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
  take_refined(likelihood::refine(out.model, still, likelihood_options(options), progress), options,
               out);
  return out;
}

}  // namespace

FitResult fit(BeamSource& source, const FitOptions& options, const FitProgress& progress) {
  const Fitter& fitter = checked_fitter(options);
  FitBeams beams(source, options);
  const ChannelOffsets channels = offsets_of(beams, options);
  CorrectedBeams corrected(beams.ends, channels);
  FitResult out = fitter.refines ? fit_by_refinement(corrected, options, progress)
                                 : fitter.fit(corrected, options, progress);
  out.model.channels = channels;
  learn_the_rest(beams, options, fitter, out);
  return out;
}

}  // namespace underbrush::fit
