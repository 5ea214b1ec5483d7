/// \file
/// The progress of the tasks of a plan.
#pragma once
#include "underbrush/jobs/record.hpp"

namespace underbrush::jobs {

/// The tasks of a plan by their outcome; each is in one of the lists.
struct PlanStatus {
  std::vector<size_t> done, failed, missing;
  /// Tasks whose record disagrees with the plan or an output, and why.
  std::map<size_t, std::string> wrong;
  std::map<size_t, Failure> failures;  ///< The records of the tasks in `failed`.
  double seconds = 0;                  ///< s; the sum over the tasks that are done.
  double processor_s = 0;              ///< s; the sum of their processor times.
  uint64_t peak_memory_bytes = 0;      ///< The most memory that one of them took.
  uint64_t output_bytes = 0;           ///< The size of all of their outputs.
};

/// Returns the progress of a plan's tasks; `outputs` also compares the outputs' bytes with the
/// records. Throws `FormatError` where the plan's file is damaged.
PlanStatus status_of(const std::filesystem::path& folder, const Plan& plan, bool outputs = false);

}  // namespace underbrush::jobs
