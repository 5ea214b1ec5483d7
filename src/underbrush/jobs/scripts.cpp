#include "underbrush/jobs/scripts.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "underbrush/core/check.hpp"
#include "underbrush/jobs/plan_folder.hpp"

namespace underbrush::jobs {
namespace {

/// The tasks of each stage.
std::map<size_t, std::vector<size_t>> stages_of(const Plan& plan) {
  std::map<size_t, std::vector<size_t>> out;
  for (size_t k = 0; k < plan.tasks.size(); ++k) out[plan.tasks[k].stage].push_back(k);
  return out;
}

/// The numbers as Slurm writes them, with ranges: 0-3,7.
std::string ranges_of(const std::vector<size_t>& numbers) {
  std::string out;
  for (size_t k = 0; k < numbers.size();) {
    size_t end = k;
    while (end + 1 < numbers.size() && numbers[end + 1] == numbers[end] + 1) ++end;
    out += (out.empty() ? "" : ",") + std::to_string(numbers[k]);
    if (end > k) out += "-" + std::to_string(numbers[end]);
    k = end + 1;
  }
  return out;
}

/// A path as a word of a shell.
std::string quoted(const std::filesystem::path& path) {
  std::string out = "'";
  for (const char c : path.string()) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

}  // namespace

std::string slurm_script(const std::filesystem::path& folder, const Plan& plan) {
  std::ostringstream out;
  const std::string plan_word = quoted(folder);
  out << "#!/bin/sh\n# Submits the tasks of an underbrush plan to Slurm: run it where the plan was "
         "made.\n"
         "# What is done already is not run again, so it may be submitted again.\nset -e\nafter=\n";
  for (const auto& [stage, tasks] : stages_of(plan)) {
    double seconds = 0;
    uint64_t bytes = 0;
    for (const size_t k : tasks) {
      seconds = std::max(seconds, plan.tasks[k].seconds);
      bytes = std::max(bytes, plan.tasks[k].memory_bytes);
    }
    out << "id=$(sbatch --parsable $after --requeue --cpus-per-task=1 --array=" << ranges_of(tasks)
        << " --time=" << uint64_t(std::ceil(seconds / 6)) << " --mem=" << ((2 * bytes) >> 20) + 1
        << "M <<'END'\n#!/bin/sh\nfor time in first second third; do\n  underbrush run "
        << plan_word
        << " --task \"$SLURM_ARRAY_TASK_ID\" --threads 1 && exit\ndone\nexit 1\nEND\n)\n"
        << "after=--dependency=afterany:${id%%;*}\n";
  }
  out << "sbatch $after --requeue --cpus-per-task=1 <<'END'\n#!/bin/sh\nunderbrush plan --status "
      << plan_word << "\nexec underbrush merge " << plan_word << "\nEND\n";
  return out.str();
}

std::string makefile(const std::filesystem::path& folder, const Plan& plan) {
  const std::string path = folder.string();
  require(path.find_first_of(" \t\n:#$%'\\") == std::string::npos,
          "plan: a makefile cannot name a folder with blanks or special characters");
  std::ostringstream out;
  const std::string records = path + "/" + kRecords + "/";
  out << "# Runs the tasks of an underbrush plan, where it was made: make -j N -k -f FILE\n"
      << "merge:";
  for (size_t k = 0; k < plan.tasks.size(); ++k) out << " " << records << k << ".json";
  out << "\n\tunderbrush merge " << path << "\n.PHONY: merge\n"
      << records << "%.json:\n\tunderbrush run " << path << " --task $* --threads 1\n";
  for (size_t k = 0; k < plan.tasks.size(); ++k) {
    if (plan.tasks[k].earlier.empty()) continue;
    out << records << k << ".json: |";
    for (const EarlierOutput& e : plan.tasks[k].earlier) out << " " << records << e.task << ".json";
    out << "\n";
  }
  return out.str();
}

}  // namespace underbrush::jobs
