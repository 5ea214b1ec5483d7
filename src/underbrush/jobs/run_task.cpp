#include "underbrush/jobs/run_task.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/io/hash.hpp"
#include "underbrush/jobs/child.hpp"
#include "underbrush/jobs/plan_folder.hpp"
#include "underbrush/regions/world_folder.hpp"

namespace underbrush::jobs {
namespace fs = std::filesystem;
namespace {

constexpr size_t kMostPrinted = 2000;  // bytes of a failed task's text that are kept

/// The record of a task that stands; nothing where there is none or it is not true.
std::optional<Record> true_record(const fs::path& folder, const Plan& plan, size_t number) {
  try {
    return checked_record(folder, plan, number);
  } catch (const FormatError&) {
    return {};
  }
}

std::map<std::string, std::string> checked_inputs(const Plan& plan, const Task& task) {
  std::map<std::string, std::string> out;
  for (const std::string& path : task.inputs) {
    if (!fs::exists(path)) {
      throw FormatError(path, "", "missing: run tasks where the plan was made");
    }
    out[path] = io::hash_of_all(regions::hashed_parts(path));
    if (out[path] != plan.inputs.at(path).hash) {
      throw FormatError(path, "", "not what it was when the plan was made: its hash differs");
    }
  }
  return out;
}

/// What earlier tasks have left for a task, as the words of its command and their hashes.
struct Earlier {
  std::vector<std::string> words, hashes;
};

Earlier earlier_of(const fs::path& folder, const Plan& plan, const Task& task) {
  Earlier out;
  std::map<size_t, Record> records;
  for (const EarlierOutput& e : task.earlier) {
    if (!records.contains(e.task)) {
      const auto record = checked_record(folder, plan, e.task);
      if (!record) {
        throw FormatError(folder.string(), "task " + std::to_string(e.task),
                          "was not run, and this task needs what it makes");
      }
      records[e.task] = *record;
    }
    const MadeOutput& made = records[e.task].outputs[e.output];
    out.words.push_back(e.option + "=" + (folder / made.path).string());
    out.hashes.push_back(made.hash);
  }
  return out;
}

std::string end_of(const fs::path& printed) {
  if (!is_file(printed)) return {};
  std::string text = read_file(printed);
  if (text.size() > kMostPrinted) text = text.substr(text.size() - kMostPrinted);
  return text;
}

/// Gives a folder of outputs its place, which has the name of its contents. What already stands
/// there is the same, from another run, or was changed since.
fs::path placed(const fs::path& made, const fs::path& plan, size_t number) {
  const std::string hash = io::hash_of(made);
  fs::path name =
      fs::path(kOutputs) / (std::to_string(number) + "-" + hash.substr(hash.find(':') + 1, 16));
  const fs::path target = plan / name;
  std::error_code error;
  if (fs::exists(target) && io::hash_of(target) != hash) fs::remove_all(target);
  fs::rename(made, target, error);
  if (error && !fs::exists(target)) throw IoError(target.string() + ": " + error.message());
  return name;
}

}  // namespace

TaskEnd run_task(const fs::path& folder, size_t number, const std::string& program,
                 const std::string& version, int threads) {
  const Plan plan = read_plan(folder);
  require(number < plan.tasks.size(), "run: the plan has no task of this number");
  if (version != plan.program) {
    throw DataError("the plan is of " + printable(plan.program) + ", and this is " + version);
  }
  if (const auto record = true_record(folder, plan, number)) return {false, *record, {}};
  const Task& task = plan.tasks[number];
  const Earlier earlier = earlier_of(folder, plan, task);
  TaskEnd out{
      true,
      {hash_of_plan(folder), version, task.command, checked_inputs(plan, task), earlier.hashes, {}},
      {}};
  const TemporaryPath temporary(folder, "task");
  make_temporary_folders(temporary.path());
  std::vector<std::string> words = started(task.command, program);
  words.insert(words.end(), earlier.words.begin(), earlier.words.end());
  for (const TaskOutput& o : task.outputs) {
    words.insert(words.end(), {o.option, (temporary.path() / o.name).string()});
  }
  if (threads > 0) words.push_back("--threads=" + std::to_string(threads));
  const fs::path printed = temporary.path().parent_path() / "printed";
  const ChildEnd end = run_child(words, printed);
  const auto missing = std::ranges::find_if(
      task.outputs, [&](const TaskOutput& o) { return !fs::exists(temporary.path() / o.name); });
  if (!has_ended(task.command, end.exit_code) || missing != task.outputs.end()) {
    const std::optional<Failure> before = read_failure(folder, number);
    out.failure = {(before ? before->times : 0) + 1, end.exit_code, end_of(printed)};
    if (has_ended(task.command, end.exit_code))
      out.failure.last_lines += "it made no " + missing->name + "\n";
    write_failure(folder, number, out.failure);
    return out;
  }
  out.record.seconds = end.seconds;
  out.record.processor_s = end.processor_s;
  out.record.peak_memory_bytes = end.peak_memory_bytes;
  for (const TaskOutput& o : task.outputs) {
    out.record.outputs.push_back({o.name, io::hash_of(temporary.path() / o.name)});
    out.record.output_bytes += io::size_of(temporary.path() / o.name);
  }
  const fs::path place = placed(temporary.path(), folder, number);
  for (MadeOutput& o : out.record.outputs) o.path = (place / o.path).string();
  write_record(folder, number, out.record);
  fs::remove(record_file(folder, number, true));
  return out;
}

}  // namespace underbrush::jobs
