/// \file
/// The table of the parameters of a fit: the command line, configurations, the search for
/// parameters and the reference page all loop over it.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "underbrush/fit/fit.hpp"

namespace underbrush::fit {

/// The part of a fit that a parameter belongs to. A fitter has the parameters of some groups.
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

/// The name of a group as help texts head it, such as "hit probability".
std::string_view name_of(ParameterGroup group);

/// How the range of a parameter is walked when it is tuned.
enum class Scale {
  kLinear,
  kLog,    ///< Equal factors are equal steps; `low` is positive.
  kWhole,  ///< The same, rounded to whole numbers.
};

/// The range in which a parameter is looked for.
struct TuningRange {
  double low = 0, high = 1;
  Scale scale = Scale::kLinear;
  bool usual = true;  ///< Tuned unless names are given.
};

/// Where a parameter lies in `FitOptions`.
using ParameterField =
    std::variant<double& (*)(FitOptions&), int& (*)(FitOptions&), unsigned& (*)(FitOptions&),
                 bool& (*)(FitOptions&), std::string& (*)(FitOptions&)>;

/// A parameter of a fit.
struct Parameter {
  std::string_view name;  ///< As an option of the command line and a key of a configuration.
  ParameterGroup group;
  std::string_view unit;  ///< "m", "nats", …; empty where there is none.
  std::string_view help;
  ParameterField field;
  bool usual = false;                                ///< Most users need it.
  std::optional<TuningRange> tuning = std::nullopt;  ///< None: not tuned.
  std::vector<std::string> (*choices)() = nullptr;   ///< The values that a word may have.

  /// The value as a number. Throws `std::invalid_argument` for a word.
  double number(const FitOptions& options) const;
  /// Sets a number, truncated where the field is whole. Throws likewise.
  void set_number(FitOptions& options, double value) const;
  /// The value as text, such as "0.1", "true" or "first".
  std::string text(const FitOptions& options) const;
};

/// All parameters, in the order in which a search walks them.
std::span<const Parameter> parameters();

/// A parameter as one fitter has it.
struct FitterParameter {
  const Parameter* parameter = nullptr;
  bool usually_tuned = false;  ///< A search tunes it unless names are given.
};

/// The parameters that have an effect with the fitter of `options`; for `likelihood` these are its
/// own and those of its start. Throws `std::invalid_argument` for an unknown fitter.
std::vector<FitterParameter> parameters_of(const FitOptions& options);

}  // namespace underbrush::fit
