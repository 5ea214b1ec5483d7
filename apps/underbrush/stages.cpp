#include "stages.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <optional>

#include "cli/progress.hpp"
#include "report/intensity_table.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/log_file.hpp"

namespace underbrush::app {
namespace fs = std::filesystem;
namespace {

using Value = std::function<double(const metrics::Score&)>;

std::string row(const std::string& label, const std::vector<metrics::Score>& scores,
                const Value& value, int digits) {
  std::string line = fmt::format("  {:<24}", label);
  for (const metrics::Score& s : scores) {
    const double x = value(s);
    line += std::isfinite(x) ? fmt::format("{:>14.{}f}", x, digits) : fmt::format("{:>14}", "n/a");
  }
  return line + "\n";
}

std::string row(const char* label, const std::vector<metrics::Score>& scores,
                double metrics::Summary::*value, int digits) {
  return row(
      label, scores, [&](const metrics::Score& s) { return s.all.*value; }, digits);
}

}  // namespace

void add_report_option(Verb& verb, std::string& folder) {
  verb.output("--report", folder, "Write a report (one HTML file) into this folder", {"index.html"})
      ->type_name("DIR");
}

pipeline::Scores score_logs(const fs::path& real, const fs::path& train,
                            const std::vector<Candidate>& candidates,
                            const pipeline::ScoreOptions& options) {
  const auto opened = [](const fs::path& log) -> metrics::OpenLog {
    if (log.empty()) return {};
    return [log] { return std::make_unique<io::BeamReader>(log); };
  };
  pipeline::ScoreInput input{opened(real), opened(train), {}};
  for (const Candidate& c : candidates) {
    input.simulated.push_back({c.name, c.log.string(), opened(c.log), {}});
    if (c.model.empty()) continue;
    input.simulated.back().world = [&c] {
      return std::make_shared<const pipeline::TracedWorld>(pipeline::open_world(c.model));
    };
  }
  std::optional<Progress> progress;
  return pipeline::score_logs(
      input, options,
      [&, shown = std::string()](const std::string& name, size_t done, size_t total) mutable {
        if (!progress || shown != name) progress.emplace("score " + (shown = name));
        (*progress)(done, total);
        if (done == total) progress.reset();  // The line ends.
      });
}

std::string text_of_scores(const pipeline::Scores& all) {
  using metrics::Score, metrics::Summary;
  std::vector<Score> simulated, scores;
  std::string names;
  for (const auto* part : {&all.simulated, &all.baselines}) {
    for (const pipeline::LogScore& s : *part) {
      scores.push_back(s.score);
      names += fmt::format("{:>14}", s.name);
    }
    if (part == &all.simulated) simulated = scores;
  }
  std::string text =
      fmt::format("  {:<24}{}\n", fmt::format("{} beams", scores.at(0).all.beams), names);
  text += row("recall of misses", scores, &Summary::recall_of_misses, 4);
  text += row("precision of misses", scores, &Summary::precision_of_misses, 4);
  text += row("F1 of misses", scores, &Summary::f1_of_misses, 4);
  text += row("informedness", scores, &Summary::informedness, 4);
  text += row("capped error, m", scores, &Summary::capped_error_m, 3);
  for (const auto& [support, part] : scores[0].per_support) {
    text += row(
        fmt::format("  {} {} beams", part.beams, support), scores,
        [name = &support](const Score& s) {
          const auto of_log = s.per_support.find(*name);
          return of_log == s.per_support.end() ? NAN : of_log->second.capped_error_m;
        },
        3);
  }
  if (!scores[0].per_support.empty()) {
    text += "    (by whether the beam ends in space that the model's log observed)\n";
  }
  if (scores[0].likelihood) {
    text += row(
        "calibration error", scores, [](const Score& s) { return s.reliability.error(); }, 4);
    text +=
        "    (of the probability of a return: its mean distance from the share that returned)\n";
  }
  text += row("packet error, m", scores, &Summary::packet_error_m, 3);
  text += row("precision of hits", scores, &Summary::precision, 4);
  text += row("recall of hits", scores, &Summary::recall, 4);
  text += row("F1 of hits", scores, &Summary::f1, 4);
  text += row("median range error, m", scores, &Summary::median_range_error_m, 3);
  if (scores[0].cloud) {
    text += row("point cloud error, m", scores, &Summary::cloud_error_m, 4);
    text += row("density-aware Chamfer", scores, &Summary::density_aware_chamfer, 4);
  }
  if (std::isfinite(scores[0].real_roughness_m)) {
    const std::string label = fmt::format("roughness, m ({:.3f})", scores[0].real_roughness_m);
    text += row(
        label, scores, [](const Score& s) { return s.roughness_m; }, 3);
    text += "    (median second difference of ranges along a ring; of the real log in brackets)\n";
  }
  if (scores[0].likelihood) {
    text += row("neg. log-likelihood", scores, &Summary::nll_per_beam, 4);
    text += row("CRPS of the range, m", scores, &Summary::crps_m, 3);
    text += "    (a miss counts as the maximum range there, so a wrong one costs many metres)\n";
  }
  return text + report::table_of_intensities(simulated);
}

std::string text_of_warnings(const std::vector<std::string>& warnings) {
  std::string text;
  for (const std::string& w : warnings) text += "  warning     " + w + "\n";
  return text;
}

}  // namespace underbrush::app
