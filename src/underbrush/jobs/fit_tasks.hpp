/// \file
/// The tasks of a fit. It is internal to the module.
#pragma once
#include "underbrush/jobs/plan.hpp"

namespace underbrush::jobs {

/// The value of an option of a command; empty where it has none.
std::string value_of(const std::vector<std::string>& words, const std::string& option);

/// Adds the tasks of a fit by refinement, in whose stages the rows of its logs are cut into pieces.
/// `whole` is the fit as one task without outputs, and `words` is its command with all settings.
/// Returns the number of the task that makes the model. Throws `std::invalid_argument` for a fit
/// that has no stages.
size_t add_fit(const Task& whole, const std::vector<std::string>& words, size_t pieces, Plan& plan);

}  // namespace underbrush::jobs
