/// \file
/// A parameter θ_k that is tuned, and its range.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "underbrush/fit/parameters.hpp"

namespace underbrush {
/// Parameters tuned on a log.
namespace optimize {

using fit::Scale;

/// A parameter by its name on the command line, with the range in which it is looked for.
struct Parameter {
  std::string name;
  double low = 0, high = 1;
  Scale scale = Scale::kLinear;
};

/// The value at a place of the range, 0 = `low` to 1 = `high` (clamped), rounded to four digits or
/// to a whole number: what is written down is what was tried.
double value_at(const Parameter& parameter, double place);

/// The place of a value, clamped to [0, 1].
double place_of(const Parameter& parameter, double value);

/// Those of `known` with the given names, in the order of the names; all where there is none.
/// Throws `std::invalid_argument`, naming the nearest, for a name that is not known or comes twice.
std::vector<size_t> chosen(std::span<const Parameter> known, std::span<const std::string> names);

}  // namespace optimize
}  // namespace underbrush
