/// \file
/// A plan: the tasks of a job, their inputs and outputs, and the results joined from these. Its
/// folder holds `plan.json` (share/schemas/plan.json), and later the outputs and records of tasks.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "underbrush/jobs/job.hpp"

namespace underbrush::jobs {

/// A file or folder that tasks read.
struct Input {
  std::string hash;  ///< The result of `io::hash_of`.
  uint64_t bytes = 0;
};

/// A file or folder that a task makes.
struct TaskOutput {
  std::string option;  ///< The option of the command that names it.
  std::string name;    ///< Its file name.
};

/// An output of a task of an earlier stage that a task takes.
struct EarlierOutput {
  std::string option;  ///< The option of the command that gets the path.
  size_t task = 0;
  size_t output = 0;  ///< The number of the output among those of that task.
};

/// A command that depends on no other task of its stage.
struct Task {
  size_t stage = 0;                  ///< After those of the tasks whose outputs it takes.
  std::vector<std::string> command;  ///< The words after the program's name, without outputs.
  std::vector<std::string> inputs;   ///< Paths, as the command names them.
  std::vector<EarlierOutput> earlier;
  std::vector<TaskOutput> outputs;
  uint64_t seed = 1;
  double seconds = 0;         ///< s; one core's time, roughly guessed or estimated (`estimate`).
  uint64_t memory_bytes = 0;  ///< Peak memory, guessed or estimated.
  uint64_t output_bytes = 0;  ///< Size of its outputs; known of estimates alone.
  size_t command_number = 0;  ///< The number of the job's command; not in the plan's file.
};

/// A file or folder that `merge` makes: an output of one task, or the logs of several, joined.
struct Result {
  std::string path;
  std::vector<size_t> tasks;  ///< Its tasks in the order of the beams.
  size_t output = 0;          ///< The number of the output among those of its task.
  size_t first_chunk = 0;     ///< Beams that the writer of a joined log gets first; else 0.
};

/// A job cut into tasks.
struct Plan {
  std::string program;                  ///< Name and version; tasks and `merge` need the same.
  std::map<std::string, Input> inputs;  ///< By path, relative to where the plan was made.
  std::vector<Task> tasks;
  std::vector<Result> results;
};

/// Makes the plan of a job: counts the beams of commands that are cut, and hashes all inputs, which
/// are the words of the command that name a file or folder. A fit that is cut becomes tasks of its
/// stages (`run_fit_stage`). Throws `std::invalid_argument` for a verb whose tasks are not
/// independent, for a command without output, and for two results of one name; throws what the
/// readers of logs throw.
Plan make_plan(const Job& job, const std::string& program);

/// Writes a plan's folder, whole or not at all. Throws `IoError`, also where something stands
/// there, unless `replace` is set.
void write_plan(const std::filesystem::path& folder, const Plan& plan, bool replace = false);
/// Reads the plan of a folder. Throws `FormatError`.
Plan read_plan(const std::filesystem::path& folder);

}  // namespace underbrush::jobs
