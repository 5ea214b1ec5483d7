/// \file
/// The record that a task leaves, and the check of the record.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/jobs/plan.hpp"

namespace underbrush::jobs {

/// An output that a task made.
struct MadeOutput {
  std::string path;  ///< Relative to the plan's folder.
  std::string hash;  ///< The result of `io::hash_of`.
};

/// The record of a task that is done.
struct Record {
  std::string plan;  ///< The hash of the plan's file.
  std::string program;
  std::vector<std::string> command;
  std::map<std::string, std::string> inputs;  ///< The hash of each input, by path.
  std::vector<std::string> earlier;           ///< The hashes of the outputs of earlier tasks.
  std::vector<MadeOutput> outputs;            ///< The outputs in the order of the task's.
  double seconds = 0;
  double processor_s = 0;
  uint64_t peak_memory_bytes = 0;
  uint64_t output_bytes = 0;
};

/// The record of a task that failed.
struct Failure {
  size_t times = 0;
  int exit_code = 0;       ///< 128 and the signal's number where a signal ended the task.
  std::string last_lines;  ///< The last lines that the last run printed.
};

/// Writes the record of a task that is done, in the place of one that stands. Throws `IoError`.
void write_record(const std::filesystem::path& folder, size_t task, const Record& record);
/// Writes the record of a task that failed. Throws `IoError`.
void write_failure(const std::filesystem::path& folder, size_t task, const Failure& failure);

/// Reads the record of a task and compares it with the plan and, with `outputs`, with the bytes of
/// the outputs. Returns nothing if there is no record. Throws `FormatError` where they disagree:
/// the record is damaged or of another plan, program, command or input, or an output differs from
/// it.
std::optional<Record> checked_record(const std::filesystem::path& folder, const Plan& plan,
                                     size_t task, bool outputs = true);
/// Reads the record of a failed task, if there is one. Throws `FormatError`.
std::optional<Failure> read_failure(const std::filesystem::path& folder, size_t task);

/// The hash of a plan's file.
std::string hash_of_plan(const std::filesystem::path& folder);

}  // namespace underbrush::jobs
