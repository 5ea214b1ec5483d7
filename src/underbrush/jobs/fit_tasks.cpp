#include "underbrush/jobs/fit_tasks.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/fit/fit_options.hpp"
#include "underbrush/io/log_sequence.hpp"

namespace underbrush::jobs {
namespace {

/// Rough costs of a row of the logs: of all before the refinement, of a pass, and of all after it.
constexpr double kSecondsBefore = 3e-6, kSecondsOfPass = 1e-6, kSecondsAfter = 1.5e-6;
constexpr int kMostRounds = 100;

const fit::FitOptions kDefaults;

/// The logs of a fit, in the order of its command.
io::LogSequence logs_of(const Task& fit) {
  std::vector<std::filesystem::path> logs;
  for (const std::string& word : fit.command) {
    const bool is_input = std::ranges::find(fit.inputs, word) != fit.inputs.end();
    if (is_input && io::is_log_name(word)) logs.emplace_back(word);
  }
  require(!logs.empty(), "a fit that is cut into pieces names its logs, which are .ply or .ublog");
  return io::LogSequence(std::move(logs));
}

int rounds_of(const std::vector<std::string>& words) {
  const std::string given = value_of(words, "--rounds");
  int rounds = kDefaults.likelihood.rounds;
  try {
    if (!given.empty()) rounds = std::stoi(given);
  } catch (const std::logic_error&) {
    rounds = 0;
  }
  require(rounds >= 1 && rounds <= kMostRounds,
          "a fit that is cut into pieces has 1 to 100 --rounds");
  return rounds;
}

void check_stages(const std::vector<std::string>& words) {
  const std::string fitter = value_of(words, "--fitter");
  require(fitter.empty() || fitter == kDefaults.fitter,
          "only fits by likelihood are cut into pieces, which sum up its passes");
  require(value_of(words, "--echoes") != "all",
          "a fit of all echoes is not cut into pieces, because a beam may lie in two of them");
  for (const char* option : {"--export-splat", "--export-ground"}) {
    require(value_of(words, option).empty(), "a fit that is cut into pieces exports nothing");
  }
}

}  // namespace

std::string value_of(const std::vector<std::string>& words, const std::string& option) {
  for (size_t k = 0; k < words.size(); ++k) {
    if (words[k] == option && k + 1 < words.size()) return words[k + 1];
    if (words[k].starts_with(option + "=")) return words[k].substr(option.size() + 1);
  }
  return {};
}

size_t add_fit(const Task& whole, const std::vector<std::string>& words, size_t pieces,
               Plan& plan) {
  check_stages(words);
  const size_t rounds = size_t(rounds_of(words)), rows = logs_of(whole).size();
  pieces = std::min(pieces, std::max<size_t>(rows, 1));
  const auto add = [&](size_t stage, const std::string& name, const char* output, double seconds,
                       std::vector<EarlierOutput> earlier) {
    Task task = whole;
    task.stage = stage;
    task.command.push_back("--stage=" + name);
    task.earlier = std::move(earlier);
    task.outputs = {{"-o", output}};
    task.seconds += seconds;
    plan.tasks.push_back(std::move(task));
    return plan.tasks.size() - 1;
  };
  const size_t start = add(0, "begin", "start", kSecondsBefore * double(rows), {});
  size_t latest = start;
  for (size_t round = 1; round <= rounds; ++round) {
    std::vector<EarlierOutput> of_step{{"--from", start}, {"--from", latest}};
    for (size_t k = 0; k < pieces; ++k) {
      const size_t first = rows / pieces * k + std::min(k, rows % pieces);
      const size_t end = first + rows / pieces + (k < rows % pieces ? 1 : 0);
      const std::string name = "sum:" + std::to_string(first) + ":" + std::to_string(end);
      of_step.push_back(
          {"--from", add(2 * round - 1, name, "sums.bin", kSecondsOfPass * double(end - first),
                         {{"--from", latest}})});
    }
    const bool is_last = round == rounds;
    latest = add(2 * round, is_last ? "end" : "step", is_last ? "model" : "refinement",
                 is_last ? kSecondsAfter * double(rows) : 0, std::move(of_step));
  }
  return latest;
}

}  // namespace underbrush::jobs
