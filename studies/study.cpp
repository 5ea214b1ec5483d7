#include "studies/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/page.hpp"
#include "report/summary_page.hpp"
#include "underbrush/io/json_text.inl"

namespace underbrush::studies {
namespace fs = std::filesystem;
namespace {

std::string sentence(const Check& c) {
  return fmt::format("{}: {:.4g}, must be {} {:.4g}", c.what, c.value,
                     c.at_most ? "at most" : "at least", c.limit);
}

std::string checks_html(const StudyResult& result) {
  std::string html = "<ul>\n";
  for (const Check& c : result.checks) {
    html +=
        fmt::format("<li>{} {}</li>\n", c.holds() ? "✓" : "<b>✗</b>", report::escaped(sentence(c)));
  }
  return html + "</ul>\n";
}

}  // namespace

bool holds(std::span<const Check> checks) {
  return !checks.empty() && std::ranges::all_of(checks, &Check::holds);
}

std::string verdict(std::span<const Check> checks) {
  if (checks.empty()) return "falls short: nothing was compared";
  std::string short_of;
  for (const Check& c : checks) {
    if (!c.holds()) short_of += (short_of.empty() ? "" : "; ") + sentence(c);
  }
  return short_of.empty() ? "holds" : "falls short: " + short_of;
}

std::vector<fs::path> halved_logs(const fs::path& data) {
  std::vector<fs::path> logs;
  for (const auto& entry : fs::directory_iterator(data)) {
    if (fs::exists(entry.path() / "train.ply") && fs::exists(entry.path() / "test.ply")) {
      logs.push_back(entry.path());
    }
  }
  std::sort(logs.begin(), logs.end());
  return logs;
}

Json json_of(const Study& study, const StudyResult& result) {
  Json checks = Json::array();
  for (const Check& c : result.checks) {
    checks.push_back({{"what", c.what},
                      {"value", io::finite_or_null(c.value)},
                      {c.at_most ? "at_most" : "at_least", c.limit},
                      {"holds", c.holds()}});
  }
  return {{"study", study.name},
          {"verdict", verdict(result.checks)},
          {"checks", checks},
          {"figures", result.figures},
          {"notes", result.notes}};
}

std::string text_of(const StudyResult& result) {
  std::string text;
  for (const report::Table& table : result.tables) text += text_of(table) + "\n";
  for (const std::string& note : result.notes) text += "note: " + note + "\n";
  return text + "verdict: " + verdict(result.checks) + "\n";
}

fs::path write_study_report(const fs::path& folder, const Study& study, const StudyResult& result,
                            const std::string& provenance) {
  std::string body;
  for (const report::Table& table : result.tables) body += report::html_of(table);
  for (const std::string& note : result.notes) body += "<p>" + report::escaped(note) + "</p>\n";
  return report::write_summary_page(folder, {.title = fmt::format("Study: {}", study.name),
                                             .lead = result.lead,
                                             .verdict = verdict(result.checks),
                                             .asked = checks_html(result),
                                             .body = body + result.pictures,
                                             .provenance = provenance});
}

}  // namespace underbrush::studies
