/// \file
/// The options of the verb `optimize`, and their table.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "underbrush/core/option.hpp"
#include "underbrush/optimize/search.hpp"
#include "underbrush/optimize/slice.hpp"

namespace underbrush::optimize {

/// The options of `optimize`.
struct TuneOptions {
  uint64_t seed = 1;
  std::string objective = "packet_f1";  ///< One of `objectives`.
  std::vector<std::string> tune;        ///< Names of the parameters; none means the usual ones.
  std::vector<double> slice{SliceOptions().from_s, SliceOptions().to_s};  ///< s.
  unsigned validate = SliceOptions().one_in;
  SearchOptions search;

  /// The slice that these options describe. Throws `std::invalid_argument` for values out of range.
  SliceOptions cut() const;
};

/// The options of `optimize`. Inputs, outputs and the seed are not in the table.
std::span<const Option<TuneOptions>> tune_options();

}  // namespace underbrush::optimize
