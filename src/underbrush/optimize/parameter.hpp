/// \file
/// This file has a parameter that is tuned, and its range.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "underbrush/fit/parameters.hpp"

namespace underbrush {
/// Optimisation: it tunes parameters on a log.
namespace optimize {

using fit::Scale;

/// A parameter by its name on the command line, and the range in which its value is searched.
struct Parameter {
  std::string name;
  double low = 0, high = 1;
  Scale scale = Scale::kLinear;
};

/// Computes the value at a place of the range, from 0 at `low` to 1 at `high` (clamped). It is
/// rounded to four digits or to a whole number, so that the value written down is exactly the one
/// tried.
double value_at(const Parameter& parameter, double place);

/// Computes the place of a value in the range, clamped to [0, 1].
double place_of(const Parameter& parameter, double value);

/// Finds the parameters of `known` with the given names, as indices in the order of the names; all
/// if no name is given. Throws `std::invalid_argument`, which names the most similar one, for a
/// name that is unknown or occurs twice.
std::vector<size_t> chosen(std::span<const Parameter> known, std::span<const std::string> names);

}  // namespace optimize
}  // namespace underbrush
