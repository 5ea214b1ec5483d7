/// \file
/// The run of a task, which leaves whole outputs and a record, or neither.
#pragma once
#include <string>

#include "underbrush/jobs/record.hpp"

namespace underbrush::jobs {

/// The outcome of a task.
struct TaskEnd {
  bool ran = false;      ///< False for a task that was done already.
  Record record = {};    ///< The record, where the task is done.
  Failure failure = {};  ///< The failure; its `times` is 0 where the task did not fail.
};

/// Runs task `number` of the plan in `folder`, with `program` (its path) and `threads` threads (0:
/// all cores), in the working directory, from which the plan was made. A task whose record stands
/// and agrees with its outputs is not run again. Several processes may run the same task: its
/// outputs have names of their contents, and appear whole. Throws `FormatError` where an input
/// differs from the plan or an earlier task is not done, and `IoError`.
TaskEnd run_task(const std::filesystem::path& folder, size_t number, const std::string& program,
                 const std::string& version, int threads);

}  // namespace underbrush::jobs
