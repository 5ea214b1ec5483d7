/// \file
/// This file declares the table of fitters.
#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/fit/fit_options.hpp"
#include "underbrush/fit/fit_result.hpp"

namespace underbrush::fit {

/// A fitter: a named function that makes a model from a log, with the parameters that affect it.
struct Fitter {
  std::string_view name, summary;
  /// Groups of the parameters that shape the fitter's own elements; a search tunes them.
  std::vector<std::string_view> tuned;
  /// Groups of the parameters that also have an effect but that a search leaves alone.
  std::vector<std::string_view> fixed;
  /// Null for a fitter that refines.
  FitResult (*fit)(BeamSource&, const FitOptions&, const FitProgress&);
  /// Whether it starts from the model of another fitter, `FitOptions::start`.
  bool refines = false;
};

/// All fitters. The first one is the default.
std::span<const Fitter> fitters();

/// Finds a fitter by name. Throws `std::invalid_argument` for an unknown name.
const Fitter& fitter_named(std::string_view name);

/// Finds the fitter that makes the first model of a refinement, `options.start`. Where
/// `options.start` is the folder of a model, it gives the fitter of `options` itself. Throws
/// `std::invalid_argument` for an unknown fitter and for a start that itself refines.
const Fitter& start_of(const FitOptions& options);

}  // namespace underbrush::fit
