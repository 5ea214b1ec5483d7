/// \file
/// The options of the verb `fit` that are no parameters of a fit, and their table.
#pragma once
#include <span>
#include <string>

#include "underbrush/core/option.hpp"
#include "underbrush/update/update.hpp"

namespace underbrush::update {

/// The options of `fit` besides the parameters of a model.
struct FitLogOptions {
  std::string echoes = "first";  ///< "first" or "all" (`fit::take_all_echoes`).
  UpdateOptions update;
  /// The folder where the earlier logs of a model that is updated are now; "" = where they were.
  std::string logs;

  /// Throws `std::invalid_argument` for values out of range and for those of an update in a fit.
  void check(bool is_update) const;
};

/// The table of these options; those of an update are the group `kUpdateGroup`.
std::span<const Option<FitLogOptions>> fit_log_options();
inline constexpr std::string_view kUpdateGroup = "fit --update";

}  // namespace underbrush::update
