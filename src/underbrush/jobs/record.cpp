#include "underbrush/jobs/record.hpp"

#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/hash.hpp"
#include "underbrush/io/json_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/jobs/plan_folder.hpp"

namespace underbrush::jobs {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
using io::JsonValue;

Record record_of(const JsonValue& root) {
  Record out;
  out.plan = root.at("plan").text();
  out.program = root.at("program").text();
  for (const JsonValue& word : root.at("command").values()) out.command.push_back(word.text());
  const JsonValue inputs = root.at("inputs");
  for (const std::string& path : inputs.member_names()) {
    out.inputs[path] = inputs.at(path.c_str()).text();
  }
  for (const JsonValue& hash : root.at("earlier").values()) out.earlier.push_back(hash.text());
  for (const JsonValue& o : root.at("outputs").values()) {
    const fs::path& path = o.at("path").text();
    if (path.is_absolute() || *path.begin() != kOutputs || path.lexically_normal() != path) {
      o.at("path").fail("is not among the outputs");
    }
    out.outputs.push_back({o.at("path").text(), o.at("hash").text()});
  }
  out.seconds = root.at("seconds").number();
  out.processor_s = root.at("processor_s").number();
  out.peak_memory_bytes = root.at("peak_memory_bytes").count();
  out.output_bytes = root.at("output_bytes").count();
  return out;
}

/// Says what of a record is not as its plan has it; null where all is.
const char* lie_of(const Record& record, const fs::path& folder, const Plan& plan, size_t number) {
  const Task& task = plan.tasks[number];
  if (record.plan != hash_of_plan(folder)) return "it is of another plan";
  if (record.program != plan.program) return "another version of the program made it";
  if (record.command != task.command) return "it is of another command";
  std::map<std::string, std::string> inputs;
  for (const std::string& path : task.inputs) inputs[path] = plan.inputs.at(path).hash;
  if (record.inputs != inputs) return "its inputs are not those of the plan";
  if (record.earlier.size() != task.earlier.size()) return "its earlier outputs are missing";
  if (record.outputs.size() != task.outputs.size()) return "it has not the task's outputs";
  for (size_t k = 0; k < record.outputs.size(); ++k) {
    if (fs::path(record.outputs[k].path).filename() != task.outputs[k].name) {
      return "it has not the task's outputs";
    }
  }
  return nullptr;
}

}  // namespace

std::string hash_of_plan(const fs::path& folder) { return io::hash_of(folder / kPlanFile); }

void write_record(const fs::path& folder, size_t task, const Record& record) {
  Json j = {{"format", kRecordFormat}, {"version", kPlanVersion},   {"task", task},
            {"plan", record.plan},     {"program", record.program}, {"command", record.command},
            {"inputs", record.inputs}, {"earlier", record.earlier}, {"outputs", Json::array()}};
  for (const MadeOutput& o : record.outputs) {
    j["outputs"].push_back({{"path", o.path}, {"hash", o.hash}});
  }
  j["seconds"] = record.seconds;
  j["processor_s"] = record.processor_s;
  j["peak_memory_bytes"] = record.peak_memory_bytes;
  j["output_bytes"] = record.output_bytes;
  io::write_atomically(record_file(folder, task), io::text_of_json(j, 1) + "\n");
}

void write_failure(const fs::path& folder, size_t task, const Failure& failure) {
  const Json j = {{"format", kRecordFormat},
                  {"version", kPlanVersion},
                  {"task", task},
                  {"times", failure.times},
                  {"exit_code", failure.exit_code},
                  {"last_lines", failure.last_lines}};
  io::write_atomically(record_file(folder, task, true), io::text_of_json(j, 1) + "\n");
}

std::optional<Record> checked_record(const fs::path& folder, const Plan& plan, size_t task,
                                     bool outputs) {
  const fs::path path = record_file(folder, task);
  if (!is_file(path)) return {};
  const io::JsonFile file(path);
  Record record = record_of(file.manifest(kRecordFormat, kPlanVersion, "a task's record"));
  if (const char* lie = lie_of(record, folder, plan, task)) {
    throw FormatError(path.string(), "", lie);
  }
  for (const MadeOutput& o : record.outputs) {
    const fs::path made = path.parent_path().parent_path() / o.path;
    if (!fs::exists(made))
      throw FormatError(made.string(), "", "missing, but its task is recorded");
    if (outputs && io::hash_of(made) != o.hash) {
      throw FormatError(made.string(), "", "differs from the record of its task: it was changed");
    }
  }
  return record;
}

std::optional<Failure> read_failure(const fs::path& folder, size_t task) {
  const fs::path path = record_file(folder, task, true);
  if (!is_file(path)) return {};
  const io::JsonFile file(path);
  const JsonValue root = file.manifest(kRecordFormat, kPlanVersion, "a task's record");
  return Failure{root.at("times").count(), int(root.at("exit_code").count(255)),
                 root.at("last_lines").text()};
}

}  // namespace underbrush::jobs
