/// \file
/// The parts of a fit, which runs as a whole or in stages. It is internal to the module.
#pragma once
#include <string>

#include "underbrush/core/first_echoes.hpp"
#include "underbrush/fit/fitters.hpp"
#include "underbrush/fit/kept_beams.hpp"

namespace underbrush::fit {

/// The beams of a log that is fitted.
struct FitBeams {
  FitBeams(BeamSource& source, const FitOptions& options);

  KeptBeams echoes;
  FirstEchoes first_echoes;
  BeamSource& fitted;  ///< `echoes` with `all_echoes`, else `first_echoes`.
  std::string sensor;
};

/// Finds the fitter of the options. Throws `std::invalid_argument` for options out of range.
const Fitter& checked_fitter(const FitOptions& options);

/// The options with the range noise that repeated directions of the log show, if that is less.
FitOptions with_measured_noise(FitOptions options, FitBeams& beams);

/// Learns the range offsets of the channels.
ChannelOffsets offsets_of(FitBeams& beams, const FitOptions& options);

/// Makes the model that the refinement starts from, with its leaf angles. `source` has corrected
/// ranges.
FitResult start_of_refinement(BeamSource& source, const FitOptions& options,
                              const FitProgress& progress);

/// Puts a refined model in the place of the start.
void take_refined(likelihood::Refined refined, const FitOptions& options, FitResult& out);

/// Learns all but the geometry of the model from the log. The model has its channels' offsets.
void learn_all_but_geometry(FitBeams& beams, const FitOptions& options, const Fitter& fitter,
                            FitResult& out);

}  // namespace underbrush::fit
