#include "study/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/page.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"

namespace underbrush::app {
namespace fs = std::filesystem;
namespace {

/// Characters, not bytes, of UTF-8.
size_t width_of(const std::string& text) {
  return size_t(std::count_if(text.begin(), text.end(),
                              [](char c) { return (static_cast<uint8_t>(c) & 0xc0) != 0x80; }));
}

std::string padded(const std::string& text, size_t width, bool left) {
  const std::string space(width - std::min(width, width_of(text)), ' ');
  return left ? text + space : space + text;
}

std::string sentence(const Check& c) {
  return fmt::format("{}: {:.4g}, must be {} {:.4g}", c.what, c.value,
                     c.at_most ? "at most" : "at least", c.limit);
}

std::string checks_html(const StudyResult& result) {
  std::string html = "<ul>\n";
  for (const Check& c : result.checks) {
    html += fmt::format("<li>{} {}</li>\n", c.holds() ? "✓" : "<b>✗</b>", escaped(sentence(c)));
  }
  return html + "</ul>\n";
}

}  // namespace

std::string verdict(std::span<const Check> checks) {
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

std::string text_of(const StudyTable& table) {
  std::vector<size_t> width(table.head.size());
  const auto widen = [&](const std::vector<std::string>& row) {
    for (size_t c = 0; c < row.size(); ++c) width.at(c) = std::max(width[c], width_of(row[c]));
  };
  widen(table.head);
  for (const auto& row : table.rows) widen(row);
  std::string text = table.title + "\n";
  const auto add = [&](const std::vector<std::string>& row) {
    text += " ";
    for (size_t c = 0; c < row.size(); ++c) text += " " + padded(row[c], width[c] + 1, c == 0);
    text += "\n";
  };
  add(table.head);
  for (const auto& row : table.rows) add(row);
  return text;
}

std::string html_of(const StudyTable& table) {
  std::string html =
      fmt::format("<h2>{}</h2>\n<div class=\"scroll\"><table><thead><tr>", escaped(table.title));
  for (const std::string& h : table.head) html += "<th>" + escaped(h) + "</th>";
  html += "</tr></thead><tbody>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (size_t c = 0; c < row.size(); ++c) {
      html += fmt::format("<{0}>{1}</{0}>", c ? "td" : "th", escaped(row[c]));
    }
    html += "</tr>\n";
  }
  return html + fmt::format("</tbody></table></div>\n<p class=\"caption\">{}</p>\n",
                            escaped(table.caption));
}

Json json_of(const Study& study, const StudyResult& result) {
  Json checks = Json::array();
  for (const Check& c : result.checks) {
    checks.push_back({{"what", c.what},
                      {"value", std::isfinite(c.value) ? Json(c.value) : Json(nullptr)},
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
  for (const StudyTable& table : result.tables) text += text_of(table) + "\n";
  for (const std::string& note : result.notes) text += "note: " + note + "\n";
  return text + "verdict: " + verdict(result.checks) + "\n";
}

fs::path write_study_report(const fs::path& folder, const Study& study, const StudyResult& result,
                            const std::string& provenance) {
  std::string body;
  for (const StudyTable& table : result.tables) body += html_of(table);
  for (const std::string& note : result.notes) body += "<p>" + escaped(note) + "</p>\n";
  const std::string page =
      filled_study_page({{"title", fmt::format("Study: {}", escaped(study.name))},
                         {"lead", escaped(result.lead)},
                         {"verdict", escaped(verdict(result.checks))},
                         {"checks", checks_html(result)},
                         {"body", body + result.pictures},
                         {"provenance", escaped(Json::parse(provenance).dump(2))}});
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw IoError(folder.string() + ": " + failed.message());
  fs::path file = folder / "index.html";
  io::write_atomically(file, page);
  return file;
}

}  // namespace underbrush::app
