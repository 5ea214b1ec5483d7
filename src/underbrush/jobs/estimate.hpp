/// \file
/// The costs of a job, estimated from runs of small parts of it.
#pragma once
#include <string>

#include "underbrush/jobs/plan.hpp"

namespace underbrush::jobs {

/// The costs of the tasks of a plan on machines like this one.
struct Estimate {
  double processor_s = 0;     ///< s; of all tasks, one thread each.
  uint64_t memory_bytes = 0;  ///< The most memory of a task.
  uint64_t output_bytes = 0;  ///< The size of all outputs.
  size_t guessed = 0;         ///< Tasks whose costs could not be measured; their bytes are 0.
  double calibration_s = 0;   ///< s; duration of the estimate itself.
};

/// Runs small parts of some of a job's commands with `program` (its path), each on one thread, in
/// the working directory, and sets the costs of all tasks of its plan by theirs. Beams of
/// `simulate` are taken from three places of a drive. Other commands that read logs are run with
/// two parts of them, and their costs are extrapolated linearly in the rows. Commands without a log
/// keep the guesses. Throws `FormatError` where a part fails, `DataError` for too short a log.
Estimate estimate(const Job& job, const std::string& program, Plan& plan);

}  // namespace underbrush::jobs
