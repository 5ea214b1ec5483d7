/// \file
/// Scripts by which other schedulers run the tasks of a plan.
#pragma once
#include <string>

#include "underbrush/jobs/plan.hpp"

namespace underbrush::jobs {

/// Returns a shell script that submits a plan to Slurm: an array of tasks for each stage, which
/// begins once the stage before has ended, and at last the status and the merge. A task that fails
/// is run up to three times, and one whose node is lost is queued again. Each task gets twice the
/// memory and ten times the time of the plan's guess, and one processor.
std::string slurm_script(const std::filesystem::path& folder, const Plan& plan);

/// Returns a makefile for GNU make whose first target merges a plan; `make -j N` runs N tasks at
/// once, those that are not done yet.
std::string makefile(const std::filesystem::path& folder, const Plan& plan);

}  // namespace underbrush::jobs
