/// \file
/// This file has the table of the parameters of a fit. The command line, configuration files, the
/// parameter search and the reference page loop over it.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "underbrush/fit/fit_options.hpp"

namespace underbrush::fit {

/// The part of a fit that a parameter belongs to. Each fitter has the parameters of some groups.
enum class ParameterGroup {
  kCommon,          ///< Every fitter.
  kHierarchical,    ///< The clustering of `hierarchical`.
  kVoxel,           ///< The clustering of `voxel`.
  kTopDown,         ///< The clustering of `top_down`.
  kBottomUp,        ///< The clustering of `bottom_up`.
  kSurface,         ///< The opaque meshes.
  kGround,          ///< The ground mesh.
  kEllipsoids,      ///< Permeable ellipsoids.
  kHitProbability,  ///< Hit probabilities from the beams of the log.
  kLikelihood,      ///< The refinement of `likelihood`.
};

/// All groups, in the order of the enumeration.
std::span<const ParameterGroup> parameter_groups();

/// The name of a group as a heading of help texts, such as "hit probability".
std::string_view name_of(ParameterGroup group);

/// The scale on which a tuning range is walked.
enum class Scale {
  kLinear,
  kLog,    ///< Equal steps are equal factors; `low` is positive.
  kWhole,  ///< Linear, rounded to whole numbers.
};

/// The range in which a search looks for the value of a parameter.
struct TuningRange {
  double low = 0, high = 1;
  Scale scale = Scale::kLinear;
  bool usual = true;  ///< Tuned unless the user names the parameters to tune.
};

/// A function that gives the parameter's field in a `FitOptions`.
using ParameterField =
    std::variant<double& (*)(FitOptions&), int& (*)(FitOptions&), unsigned& (*)(FitOptions&),
                 bool& (*)(FitOptions&), std::string& (*)(FitOptions&)>;

/// Where a parameter is listed. Every one is a key of configurations and has its row in
/// docs/reference/parameters.md.
enum class Listed {
  kHelp,       ///< `--help`.
  kHelpAll,    ///< `--help-all`.
  kReference,  ///< Only the page; configurations of papers and of studies set it.
};

/// A parameter of a fit.
struct Parameter {
  std::string_view name;  ///< The name of the command line's option and of the configuration's key.
  ParameterGroup group;
  std::string_view unit;  ///< For example "m" or "nats"; empty for a pure number.
  std::string_view help;
  ParameterField field;
  Listed listed = Listed::kHelpAll;
  std::optional<TuningRange> tuning = std::nullopt;  ///< Empty for a parameter that is not tuned.
  /// Lists the values that a text may have, or null.
  std::vector<std::string> (*choices)() = nullptr;

  /// The value as a number. Throws `std::invalid_argument` for a text parameter.
  double number(const FitOptions& options) const;
  /// Sets the value from a number, which is truncated where the field is whole. Throws
  /// `std::invalid_argument` for a text parameter.
  void set_number(FitOptions& options, double value) const;
  /// The value as text, such as "0.1", "true" or "first".
  std::string text(const FitOptions& options) const;
};

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
