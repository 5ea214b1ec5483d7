/// \file
/// The names of the files in a plan's folder. It is internal to the module.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

namespace underbrush::jobs {

inline constexpr const char* kPlanFormat = "underbrush-plan";
inline constexpr const char* kRecordFormat = "underbrush-task";
inline constexpr uint64_t kPlanVersion = 1;
inline constexpr const char* kPlanFile = "plan.json";
inline constexpr const char* kOutputs = "outputs";
inline constexpr const char* kRecords = "records";

/// The record of a task that is done, or with `failed` that of one that failed.
inline std::filesystem::path record_file(const std::filesystem::path& plan, size_t task,
                                         bool failed = false) {
  return plan / kRecords / (std::to_string(task) + (failed ? ".failed.json" : ".json"));
}

}  // namespace underbrush::jobs
