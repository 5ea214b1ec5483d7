#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/jobs/plan.hpp"
#include "underbrush/jobs/plan_folder.hpp"

namespace underbrush::jobs {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
using io::JsonValue;

Json json_of(const Plan& plan) {
  Json j = {{"format", kPlanFormat}, {"version", kPlanVersion}, {"program", plan.program}};
  j["inputs"] = Json::object();
  for (const auto& [path, input] : plan.inputs) {
    j["inputs"][path] = {{"hash", input.hash}, {"bytes", input.bytes}};
  }
  j["tasks"] = Json::array();
  for (const Task& task : plan.tasks) {
    Json outputs = Json::array();
    for (const TaskOutput& o : task.outputs) {
      outputs.push_back({{"option", o.option}, {"name", o.name}});
    }
    Json earlier = Json::array();
    for (const EarlierOutput& e : task.earlier) {
      earlier.push_back({{"option", e.option}, {"task", e.task}, {"output", e.output}});
    }
    j["tasks"].push_back({{"stage", task.stage},
                          {"command", task.command},
                          {"inputs", task.inputs},
                          {"earlier", earlier},
                          {"outputs", outputs},
                          {"seed", task.seed},
                          {"seconds", task.seconds},
                          {"memory_bytes", task.memory_bytes},
                          {"output_bytes", task.output_bytes}});
  }
  j["results"] = Json::array();
  for (const Result& r : plan.results) {
    j["results"].push_back({{"path", r.path},
                            {"tasks", r.tasks},
                            {"output", r.output},
                            {"first_chunk", r.first_chunk}});
  }
  return j;
}

std::vector<std::string> texts_of(const JsonValue& list) {
  std::vector<std::string> out;
  for (const JsonValue& value : list.values()) out.push_back(value.text());
  return out;
}

Task task_of(const JsonValue& value) {
  Task task;
  task.stage = value.at("stage").count();
  task.command = texts_of(value.at("command"));
  task.inputs = texts_of(value.at("inputs"));
  for (const JsonValue& e : value.at("earlier").values()) {
    task.earlier.push_back({e.at("option").text(), e.at("task").count(), e.at("output").count()});
  }
  for (const JsonValue& o : value.at("outputs").values()) {
    task.outputs.push_back({o.at("option").text(), o.at("name").text()});
    const fs::path name = task.outputs.back().name;
    if (name.empty() || name != name.filename() || name == "." || name == "..") {
      o.at("name").fail("is not the name of a file");
    }
  }
  task.seed = value.at("seed").count();
  task.seconds = value.at("seconds").number();
  task.memory_bytes = value.at("memory_bytes").count();
  task.output_bytes = value.at("output_bytes").count();
  return task;
}

Result result_of(const JsonValue& value, const Plan& plan) {
  Result result;
  result.path = value.at("path").text();
  for (const JsonValue& task : value.at("tasks").values()) {
    result.tasks.push_back(task.count());
    if (result.tasks.back() >= plan.tasks.size()) task.fail("no such task");
  }
  result.output = value.at("output").count();
  result.first_chunk = value.at("first_chunk").count();
  if (result.tasks.empty()) value.at("tasks").fail("names no task");
  for (const size_t task : result.tasks) {
    if (result.output >= plan.tasks[task].outputs.size()) value.at("output").fail("no such output");
  }
  return result;
}

/// Fails where a task takes what no task of an earlier stage makes.
void check_earlier(const Task& task, const Plan& plan, const JsonValue& value) {
  for (const EarlierOutput& e : task.earlier) {
    const bool is_made = e.task < plan.tasks.size() && plan.tasks[e.task].stage < task.stage &&
                         e.output < plan.tasks[e.task].outputs.size();
    if (!is_made) value.at("earlier").fail("no task of an earlier stage makes it");
  }
}

}  // namespace

void write_plan(const fs::path& folder, const Plan& plan, bool replace) {
  if (!replace && fs::exists(fs::symlink_status(folder))) {
    throw IoError(folder.string() +
                  ": cannot write: exists; --force replaces it and all that its tasks made");
  }
  io::check_output_folder(folder, fs::is_regular_file(folder / kPlanFile), "no plan");
  const std::string text = io::text_of_json(json_of(plan), 1) + "\n";
  io::write_atomically(
      folder,
      [&](const fs::path& temporary) {
        make_temporary_folders(temporary / kOutputs);
        make_temporary_folders(temporary / kRecords);
        write_file(temporary / kPlanFile, text);
      },
      io::OutputKind::kFolder);
}

Plan read_plan(const fs::path& folder) {
  const io::JsonFile file(folder / kPlanFile);
  const JsonValue root = file.manifest(kPlanFormat, kPlanVersion, "an underbrush plan");
  Plan plan;
  plan.program = root.at("program").text();
  const JsonValue inputs = root.at("inputs");
  for (const std::string& path : inputs.member_names()) {
    const JsonValue input = inputs.at(path.c_str());
    plan.inputs[path] = {input.at("hash").text(), input.at("bytes").count()};
  }
  const std::vector<JsonValue> tasks = root.at("tasks").values();
  for (const JsonValue& task : tasks) plan.tasks.push_back(task_of(task));
  for (size_t k = 0; k < tasks.size(); ++k) {
    for (const std::string& path : plan.tasks[k].inputs) {
      if (!plan.inputs.contains(path)) inputs.fail("has no " + in_quotes(path));
    }
    check_earlier(plan.tasks[k], plan, tasks[k]);
  }
  for (const JsonValue& r : root.at("results").values()) {
    plan.results.push_back(result_of(r, plan));
  }
  return plan;
}

}  // namespace underbrush::jobs
