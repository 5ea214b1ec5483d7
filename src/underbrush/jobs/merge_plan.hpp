/// \file
/// The results of a plan, joined from the outputs of its tasks.
#pragma once
#include "underbrush/jobs/plan.hpp"

namespace underbrush::jobs {

/// Checks the records and outputs of all tasks, and writes the plan's results, each whole or not at
/// all; files and folders in their place are replaced. A log that is joined has the bytes that its
/// command gives in one run. Throws `FormatError` for the first task that is not done or whose
/// record or output is not true; then nothing is written.
void merge_plan(const std::filesystem::path& folder, const Plan& plan);

}  // namespace underbrush::jobs
