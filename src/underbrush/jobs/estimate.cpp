#include "underbrush/jobs/estimate.hpp"

#include <algorithm>
#include <chrono>
#include <map>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/credit/held_out.hpp"
#include "underbrush/io/hash.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/jobs/child.hpp"
#include "underbrush/pipeline/simulate_log.hpp"

namespace underbrush::jobs {
namespace fs = std::filesystem;
namespace {

/// The most commands that are calibrated; each other one costs as much as the one before it.
constexpr size_t kCalibrated = 3;
/// The beams of a part of a drive.
constexpr size_t kBeams = pipeline::kSimulatedBeams;
/// Rows of which enough are no held-out beams for a fit to take its first steps from shares.
constexpr size_t kLongLog = credit::kLongLog * 11 / 10;
constexpr size_t kLeastRows = 1 << 17;  // of which a run takes about a second
/// A fit keeps no longer log in memory.
constexpr double kKeptRows = 6e6;

struct Costs {
  double processor_s = 0, memory_bytes = 0, output_bytes = 0;
};

/// The costs of the tasks of a command, in their order.
using CostsOfTasks = std::vector<Costs>;

/// Runs tasks of a plan of a part of a command.
class Calibration {
 public:
  explicit Calibration(const std::string& program) : program_(program), temporary_("", "estimate") {
    make_temporary_folders(temporary_.path());
  }

  /// Runs task `number` of a plan. What it takes of tasks that were not run here is left out.
  Costs run(const Plan& plan, size_t number) {
    const Task& task = plan.tasks[number];
    const fs::path folder = temporary_.path() / std::to_string(runs_++);
    make_temporary_folders(folder);
    std::vector<std::string> words = started(task.command, program_);
    for (const EarlierOutput& e : task.earlier) {
      const auto from = made_.find(e.task);
      if (from != made_.end()) words.push_back(e.option + "=" + from->second.string());
    }
    for (const TaskOutput& o : task.outputs) {
      words.insert(words.end(), {o.option, (folder / o.name).string()});
    }
    words.emplace_back("--threads=1");
    const fs::path printed = folder.string() + ".printed";
    const ChildEnd end = run_child(words, printed);
    if (!has_ended(task.command, end.exit_code)) {
      throw FormatError(task.command[0], "",
                        "its calibration failed: " + printable(read_file(printed)));
    }
    made_[number] = folder / task.outputs[0].name;
    return {end.processor_s, double(end.peak_memory_bytes), double(io::size_of(folder))};
  }
  fs::path new_file(const std::string& suffix) {
    return temporary_.path() / (std::to_string(runs_++) + suffix);
  }

 private:
  std::string program_;
  TemporaryPath temporary_;
  size_t runs_ = 0;
  std::map<size_t, fs::path> made_;  ///< By the number of the task.
};

/// The beams [first, end) of a task of `simulate`.
std::pair<size_t, size_t> beams_of(const Task& task) {
  std::pair<size_t, size_t> out;
  require(std::sscanf(task.command.back().c_str(), "--beams=%zu:%zu", &out.first, &out.second) == 2,
          "not a task of some beams");
  return out;
}

/// Beams of three places are answered, and once few. Costs are those of a start and of each beam.
CostsOfTasks costs_of_simulate(const std::vector<std::string>& words, const Plan& plan,
                               const std::vector<size_t>& tasks, const std::string& program) {
  Calibration calibration(program);
  Plan thirds = make_plan({words, {}, 3}, "");
  Costs start, parts;
  size_t beams = 0;
  const size_t all = beams_of(thirds.tasks.back()).second;
  for (size_t k = 0; k < thirds.tasks.size(); ++k) {
    Task& task = thirds.tasks[k];
    const auto [first, end] = beams_of(task);
    // The part in the middle is so long that it needs the memory of any longer one.
    const size_t n = std::min(k == 1 ? 3 * kBeams : kBeams, end - first),
                 from = first + (end - first - n) / 2;
    const auto run = [&](size_t count) {
      task.command.back() = "--beams=" + std::to_string(from) + ":" + std::to_string(from + count);
      return calibration.run(thirds, k);
    };
    if (beams == 0) start = run(1);
    const Costs part = run(n);
    parts.processor_s += part.processor_s - start.processor_s;
    parts.output_bytes += part.output_bytes;
    parts.memory_bytes = std::max(parts.memory_bytes, part.memory_bytes);
    beams += n;
  }
  CostsOfTasks out;
  for (const size_t k : tasks) {
    const bool is_piece = plan.tasks[k].command.back().starts_with("--beams=");
    const auto [first, end] = is_piece ? beams_of(plan.tasks[k]) : std::pair(size_t(0), all);
    const double share = double(end - first) / double(beams);
    out.push_back({start.processor_s + std::max(parts.processor_s, 0.0) * share, parts.memory_bytes,
                   parts.output_bytes * share});
  }
  return out;
}

/// The words of a command that are logs.
std::vector<size_t> logs_of(const std::vector<std::string>& words) {
  std::vector<size_t> out;
  for (size_t k = 1; k < words.size(); ++k) {
    if (io::is_log_name(words[k]) && is_file(words[k])) out.push_back(k);
  }
  return out;
}

/// Copies rows of a log.
void cut(const fs::path& from, size_t first, size_t end, const fs::path& to) {
  io::LogReader reader(from);
  reader.keep_rows(first, end);
  io::LogWriter writer(to, reader.info(), reader.provenance());
  for (BeamLog chunk; reader.next(chunk);) writer.write(chunk);
  writer.close();
}

/// The rows of a log of `n` in the larger one of two runs; the smaller one has half of them.
size_t rows_of_run(size_t n) {
  // A fit of a long log takes its first steps from shares of the beams, and verbs need more memory
  // up to the million rows that they read at a time: both runs must be beyond.
  return std::min(n, std::max(n / 8, n < kLongLog ? kLeastRows : 2 * kLongLog));
}

/// Runs a command on the middle of its logs, as so many rows of each (of all logs of a fit) as
/// `rows_of_run` says over `less`. Of like tasks of a stage, one is run. `rows` gets the rows of
/// all logs in the run and whole.
CostsOfTasks run_part(std::vector<std::string> words, size_t pieces, size_t less,
                      const std::string& program, std::pair<double, double>& rows) {
  Calibration calibration(program);
  rows = {0, 0};
  const std::vector<size_t> logs = logs_of(words);
  size_t all = 0;
  for (const size_t k : logs) all += io::LogReader(words[k]).size();
  for (const size_t k : logs) {
    const size_t n = io::LogReader(words[k]).size();
    // A fit takes its logs as one.
    const double share = double(n) / double(std::max<size_t>(all, 1));
    const size_t of_run =
        words[0] == "fit" ? size_t(share * double(rows_of_run(all))) : rows_of_run(n);
    const size_t some = std::max<size_t>(of_run / less, 1);
    const fs::path file = calibration.new_file(fs::path(words[k]).extension().string());
    cut(words[k], (n - some) / 2, (n - some) / 2 + some, file);
    words[k] = file.string();
    rows.first += double(some);
    rows.second += double(n);
  }
  const Plan plan = make_plan({words, {}, pieces}, "");
  CostsOfTasks out(plan.tasks.size());
  for (size_t begin = 0, end = 0; begin < out.size(); begin = end) {
    while (end < out.size() && plan.tasks[end].stage == plan.tasks[begin].stage) ++end;
    std::fill(out.begin() + ptrdiff_t(begin), out.begin() + ptrdiff_t(end),
              calibration.run(plan, begin + (end - begin) / 2));
  }
  return out;
}

/// The costs of two runs on parts of the logs, continued to all of their rows.
CostsOfTasks costs_of_logs(const std::vector<std::string>& words, size_t pieces,
                           const std::vector<size_t>& tasks, const std::string& program) {
  std::pair<double, double> rows, fewer;
  CostsOfTasks out = run_part(words, pieces, 1, program, rows);
  const CostsOfTasks less = run_part(words, pieces, 2, program, fewer);
  require_data(out.size() == tasks.size() && less.size() == tasks.size() && fewer.first > 0,
               "estimate: the log is too short to be cut");
  for (size_t k = 0; k < out.size(); ++k) {
    const auto continued = [&](double Costs::*cost, double to) {
      const double slope = std::max(out[k].*cost - less[k].*cost, 0.0) / (rows.first - fewer.first);
      return out[k].*cost + slope * std::max(to - rows.first, 0.0);
    };
    const double kept = words[0] == "fit" ? std::min(rows.second, kKeptRows) : rows.second;
    out[k] = {continued(&Costs::processor_s, rows.second), continued(&Costs::memory_bytes, kept),
              continued(&Costs::output_bytes, rows.second)};
  }
  return out;
}

/// Nothing for a command without a log, and for one that simulates what cannot be cut.
CostsOfTasks costs_of(const std::vector<std::string>& words, size_t pieces, const Plan& plan,
                      const std::vector<size_t>& tasks, const std::string& program) {
  if (words[0] == "simulate") {
    try {
      return costs_of_simulate(words, plan, tasks, program);
    } catch (const std::invalid_argument&) {
      return {};
    }
  }
  return logs_of(words).empty() ? CostsOfTasks() : costs_of_logs(words, pieces, tasks, program);
}

}  // namespace

Estimate estimate(const Job& job, const std::string& program, Plan& plan) {
  const auto commands = commands_of(job);
  std::vector<std::vector<size_t>> tasks(commands.size());
  for (size_t k = 0; k < plan.tasks.size(); ++k) {
    tasks[plan.tasks[k].command_number].push_back(k);
  }
  const auto begin = std::chrono::steady_clock::now();
  Estimate out;
  CostsOfTasks costs;
  const size_t step = (commands.size() + kCalibrated - 1) / kCalibrated;
  for (size_t c = 0; c < commands.size(); ++c) {
    if (c % step == 0) {
      costs = costs_of(commands[c], job.pieces, plan, tasks[c], program);
    }
    for (size_t k = 0; k < tasks[c].size(); ++k) {
      Task& task = plan.tasks[tasks[c][k]];
      if (costs.empty()) {
        ++out.guessed;
      } else {
        const Costs& of = costs[std::min(k, costs.size() - 1)];
        task.seconds = of.processor_s;
        task.memory_bytes = uint64_t(of.memory_bytes);
        task.output_bytes = uint64_t(of.output_bytes);
      }
      out.processor_s += task.seconds;
      out.memory_bytes = std::max(out.memory_bytes, task.memory_bytes);
      out.output_bytes += task.output_bytes;
    }
  }
  out.calibration_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

}  // namespace underbrush::jobs
