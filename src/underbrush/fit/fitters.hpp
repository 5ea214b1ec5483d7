/// \file
/// The table of the fitters.
#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "underbrush/fit/fit.hpp"
#include "underbrush/fit/parameters.hpp"

namespace underbrush::fit {

/// A way to make a model of a log.
struct Fitter {
  std::string_view name, summary;
  std::vector<ParameterGroup> tuned;  ///< Parameters of these groups shape what is its own.
  std::vector<ParameterGroup> fixed;  ///< These have an effect too, and a search leaves them alone.
  FitResult (*fit)(BeamSource&, const FitOptions&, const FitProgress&);
  bool refines = false;  ///< It begins with the model of another fitter, `FitOptions::start`.
};

/// All fitters; the first is the default.
std::span<const Fitter> fitters();

/// The fitter of this name. Throws `std::invalid_argument` where there is none.
const Fitter& fitter_named(std::string_view name);

/// The fitter that makes the model which the fitter of `options` begins with; where that model is
/// read from a folder, the fitter of `options` itself. Throws `std::invalid_argument` for an
/// unknown fitter and for one that refines itself.
const Fitter& start_of(const FitOptions& options);

}  // namespace underbrush::fit
