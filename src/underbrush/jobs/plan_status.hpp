/// \file
/// How far the tasks of a plan are.
#pragma once
#include "underbrush/jobs/record.hpp"

namespace underbrush::jobs {

/// The tasks of a plan by what became of them; each is in one of the lists.
struct PlanStatus {
  std::vector<size_t> done, failed, missing;
  /// Tasks whose record disagrees with the plan or an output, and why.
  std::map<size_t, std::string> wrong;
  std::map<size_t, Failure> failures;  ///< The records of the tasks in `failed`.
  double seconds = 0;                  ///< s; the sum of what the tasks took that are done.
  double processor_s = 0;              ///< s; the same of processors.
  uint64_t peak_memory_bytes = 0;      ///< The most memory that one of them took.
  uint64_t output_bytes = 0;           ///< The bytes of all that they made.
};

/// Returns how far a plan's tasks are; `outputs` also compares the outputs' bytes with the records.
/// Throws `FormatError` where the plan's file is damaged.
PlanStatus status_of(const std::filesystem::path& folder, const Plan& plan, bool outputs = false);

}  // namespace underbrush::jobs
