#include <fmt/format.h>

#include "underbrush/core/check.hpp"
#include "underbrush/jobs/estimate.hpp"
#include "underbrush/jobs/merge_plan.hpp"
#include "underbrush/jobs/plan_status.hpp"
#include "underbrush/jobs/run_task.hpp"
#include "underbrush/jobs/scripts.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace plan_verb {
namespace fs = std::filesystem;

struct Arguments {
  std::string job, output, status, slurm, make;
  size_t task = 0;
  bool estimate = false;
};

std::string text_of(const std::vector<size_t>& tasks) {
  return fmt::format("{}", fmt::join(tasks.begin(),
                                     tasks.begin() + std::min<size_t>(tasks.size(), 20), " ")) +
         (tasks.size() > 20 ? " …" : "");
}

void report_status(const Verb& verb, const std::string& folder) {
  const jobs::PlanStatus s = jobs::status_of(folder, jobs::read_plan(folder));
  Json wrong = Json::object(), failed = Json::object();
  std::string text = fmt::format("{} tasks done, {} failed, {} missing, {} wrong\n", s.done.size(),
                                 s.failed.size(), s.missing.size(), s.wrong.size());
  if (!s.missing.empty()) text += fmt::format("  missing     {}\n", text_of(s.missing));
  for (const auto& [task, f] : s.failures) {
    failed[std::to_string(task)] = {
        {"times", f.times}, {"exit_code", f.exit_code}, {"last_lines", f.last_lines}};
    text += fmt::format("  task {} failed {} times, with exit code {}:\n{}\n", task, f.times,
                        f.exit_code, f.last_lines);
  }
  for (const auto& [task, why] : s.wrong) {
    wrong[std::to_string(task)] = why;
    text += fmt::format("  task {}: {}\n", task, why);
  }
  verb.report({{"done", s.done},
               {"failed", failed},
               {"missing", s.missing},
               {"wrong", wrong},
               {"seconds", s.seconds},
               {"processor_s", s.processor_s},
               {"peak_memory_bytes", s.peak_memory_bytes},
               {"output_bytes", s.output_bytes}},
              text);
}

void plan(const Verb& verb, const Arguments& a) {
  const int given = !a.job.empty() + !a.status.empty() + !a.slurm.empty() + !a.make.empty();
  require(given == 1 && a.job.empty() == a.output.empty(),
          "plan: give JOB.yaml with -o PLAN, or --status, --slurm or --make with a plan");
  if (!a.status.empty()) return report_status(verb, a.status);
  if (!a.slurm.empty()) {
    return verb.report({}, jobs::slurm_script(a.slurm, jobs::read_plan(a.slurm)));
  }
  if (!a.make.empty()) return verb.report({}, jobs::makefile(a.make, jobs::read_plan(a.make)));
  const jobs::Job job = jobs::read_job(a.job);
  jobs::Plan made;
  try {
    made = jobs::make_plan(job, "underbrush " + version());
  } catch (const std::invalid_argument& e) {
    throw FormatError(a.job, "", e.what());
  } catch (const fs::filesystem_error& e) {  // Of an input that the job names.
    throw FormatError(a.job, "", e.path1().string() + ": " + e.code().message());
  }
  Json j;
  std::string text;
  if (a.estimate) {
    const jobs::Estimate e = jobs::estimate(job, fs::read_symlink("/proc/self/exe"), made);
    j["estimate"] = {{"processor_s", e.processor_s},
                     {"memory_bytes", e.memory_bytes},
                     {"output_bytes", e.output_bytes},
                     {"guessed_tasks", e.guessed},
                     {"calibration_s", e.calibration_s}};
    text = fmt::format(
        "  estimated   {:.2g} processor hours, at most {} MiB a task, {:.3g} MB of outputs; {} "
        "tasks only guessed\n",
        e.processor_s / 3600, e.memory_bytes >> 20, 1e-6 * double(e.output_bytes), e.guessed);
  }
  jobs::write_plan(a.output, made, verb.force);
  double seconds = 0;
  for (const jobs::Task& task : made.tasks) seconds += task.seconds;
  j.update(Json{{"tasks", made.tasks.size()},
                {"results", made.results.size()},
                {"inputs", made.inputs.size()},
                {"seconds", seconds}});
  verb.report(j, fmt::format("{}: {} tasks, {} results, about {:.0f} s of one core\n{}", a.output,
                             made.tasks.size(), made.results.size(), seconds, text));
}

void run(const Verb& verb, const Arguments& a) {
  const jobs::TaskEnd end = jobs::run_task(a.job, a.task, fs::read_symlink("/proc/self/exe"),
                                           "underbrush " + version(), verb.threads);
  if (end.failure.times > 0) {
    throw IoError(fmt::format("{}: task {} failed, with exit code {}: {}", a.job, a.task,
                              end.failure.exit_code, printable(end.failure.last_lines)));
  }
  verb.report({{"task", a.task},
               {"ran", end.ran},
               {"seconds", end.record.seconds},
               {"peak_memory_bytes", end.record.peak_memory_bytes}},
              fmt::format("task {} {}: {:.1f} s, {:.0f} MiB\n", a.task,
                          end.ran ? "done" : "was done already", end.record.seconds,
                          double(end.record.peak_memory_bytes) / (1 << 20)));
}

void merge(const Verb& verb, const Arguments& a) {
  const jobs::Plan plan = jobs::read_plan(a.job);
  std::vector<Output> outputs;
  std::vector<fs::path> inputs;
  std::string text;
  Json results = Json::array();
  for (const auto& [path, input] : plan.inputs) inputs.emplace_back(path);
  for (const jobs::Result& r : plan.results) {
    outputs.push_back({"a result", r.path});
    results.push_back(r.path);
    text += fmt::format("{}: from {} tasks\n", r.path, r.tasks.size());
  }
  check_outputs(outputs, inputs, verb.force);
  jobs::merge_plan(a.job, plan);
  verb.report({{"results", results}}, text);
}

}  // namespace plan_verb
}  // namespace

void add_plan(Program& program) {
  using namespace plan_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(program, "Jobs", "plan", "Cut a job into tasks for many machines",
                             "underbrush plan job.yaml -o plan/\n"
                             "  underbrush plan --status plan/\n"
                             "  underbrush plan --slurm plan/ | sh",
                             [a](const Verb& v) { plan(v, *a); });
  verb->app.add_option("JOB", a->job, "File with a command and the inputs to repeat it for")
      ->type_name("JOB.yaml");
  verb->output("-o,--output", a->output, "The folder of the plan");
  verb->app.add_flag("--estimate", a->estimate,
                     "Run small parts of the job, and estimate its time, memory and output");
  verb->app.add_option("--status", a->status, "Print which tasks are done, failed and missing")
      ->type_name("PLAN");
  verb->app.add_option("--slurm", a->slurm, "Print a script that submits the plan to Slurm")
      ->type_name("PLAN");
  verb->app.add_option("--make", a->make, "Print a makefile that runs the plan")->type_name("PLAN");
}

void add_run(Program& program) {
  using namespace plan_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(program, "Jobs", "run", "Run a task of a plan, unless it is done",
                             "underbrush run plan/ --task 3", [a](const Verb& v) { run(v, *a); });
  verb->app.add_option("PLAN", a->job, "The folder of the plan")->required();
  verb->app.add_option("--task", a->task, "Number of the task, counted from 0")->required();
}

void add_merge(Program& program) {
  using namespace plan_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Jobs", "merge", "Check the tasks of a plan and join their results",
               "underbrush merge plan/", [a](const Verb& v) { merge(v, *a); });
  verb->app.add_option("PLAN", a->job, "The folder of the plan")->required();
}

}  // namespace underbrush::app
