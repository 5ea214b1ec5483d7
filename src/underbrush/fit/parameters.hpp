/// \file
/// This file has the table of the options of a fit, its parameters. The command line, configuration
/// files, Python, the parameter search and the reference page loop over it.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "underbrush/core/option.hpp"
#include "underbrush/fit/fit_options.hpp"
#include "underbrush/fit/parameter_groups.hpp"

namespace underbrush::fit {

/// The scale on which a tuning range is walked.
enum class Scale {
  kLinear,
  kLog,    ///< Equal steps are equal factors; `low` is positive.
  kWhole,  ///< Linear, rounded to whole numbers.
};

/// The range in which a search varies the value of a parameter.
struct TuningRange {
  double low = 0, high = 1;
  Scale scale = Scale::kLinear;
  bool usual = true;  ///< Whether it is tuned if the user names no parameters to tune.
};

/// The place where a parameter is listed. Every parameter is a key of configurations and has its
/// row in docs/reference/parameters.md.
enum class Listed {
  kHelp,       ///< `--help`.
  kHelpAll,    ///< `--help-all`.
  kReference,  ///< Only the page; configurations of papers and of studies set it.
};

/// A parameter of a fit.
struct Parameter : Option<FitOptions> {
  Listed listed = Listed::kHelpAll;
  std::optional<TuningRange> tuning = std::nullopt;  ///< Empty for a parameter that is not tuned.
};

/// The names of the fitters, in the order of their table.
std::vector<std::string> fitter_names();

/// All parameters, in the order in which a search walks them.
std::span<const Parameter> parameters();

/// A parameter of one fitter.
struct FitterParameter {
  const Parameter* parameter = nullptr;
  bool usually_tuned = false;  ///< Whether a search tunes it unless the user names the parameters.
};

/// The parameters that have an effect with the fitter of `options`. For `likelihood` these are its
/// own and those of its start. Throws `std::invalid_argument` for an unknown fitter.
std::vector<FitterParameter> parameters_of(const FitOptions& options);

/// Makes every echo a beam of its own (`FitOptions::all_echoes`); single echoes make no keyframes.
/// Throws `std::invalid_argument` if the options have keyframes that the user asked for.
void take_all_echoes(FitOptions& options, bool keyframes_asked);

}  // namespace underbrush::fit
