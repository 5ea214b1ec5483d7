/// \file
/// What a job will cost, estimated from runs of small parts of it.
#pragma once
#include <string>

#include "underbrush/jobs/plan.hpp"

namespace underbrush::jobs {

/// What the tasks of a plan will cost on machines like this one.
struct Estimate {
  double processor_s = 0;     ///< s; of all tasks, one thread each.
  uint64_t memory_bytes = 0;  ///< The most memory of a task.
  uint64_t output_bytes = 0;  ///< What all tasks make.
  size_t guessed = 0;         ///< Tasks whose costs could not be measured; their bytes are 0.
  double calibration_s = 0;   ///< s; what the estimate took.
};

/// Runs small parts of some of a job's commands with `program` (its path), each on one thread, in
/// the working directory, and sets the costs of all tasks of its plan by what they took. Beams of
/// `simulate` are taken from three places of a drive. Other commands that read logs are run with
/// two parts of them, and costs grow on with the number of rows. Commands without a log keep the
/// guesses. Throws `FormatError` where a part fails.
Estimate estimate(const Job& job, const std::string& program, Plan& plan);

}  // namespace underbrush::jobs
