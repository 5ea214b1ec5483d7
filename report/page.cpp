#include "report/page.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "report_assets.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_text.inl"

namespace underbrush::report {
namespace {

enum class Better { kLower, kHigher, kNeither };  // which values are better

struct Metric {
  const char *place, *name, *meaning;  // the place among the scores, a JSON pointer
  int digits;
  Better better;
};
constexpr Metric kMetrics[] = {
    {"/recall_of_misses", "Recall of misses",
     "Share of the real misses where the simulated beam misses too.", 4, Better::kHigher},
    {"/precision_of_misses", "Precision of misses",
     "Share of the simulated misses where the real beam missed too.", 4, Better::kHigher},
    {"/f1_of_misses", "F1 of misses", "Harmonic mean of the two.", 4, Better::kHigher},
    {"/informedness", "Informedness",
     "Recall of hits + recall of misses − 1: 0 without knowledge of the world, 1 at best.", 4,
     Better::kHigher},
    {"/capped_error_m", "Capped error, m",
     "Mean error of all beams, at most 2 m each; a wrong hit or miss counts as 2 m.", 3,
     Better::kLower},
    {"/reliability/error", "Calibration error",
     "Mean distance of the probability of a return from the share that returned.", 4,
     Better::kLower},
    {"/packet_error_m", "Packet error, m",
     "Distance between real and simulated point of beams that hit in both: mean of the packets’ "
     "means.",
     3, Better::kLower},
    {"/median_range_error_m", "Median range error, m",
     "Half of the beams that hit in both are off by less.", 3, Better::kLower},
    {"/precision", "Precision of hits", "Share of the simulated hits where the real beam hit too.",
     4, Better::kHigher},
    {"/recall", "Recall of hits", "Share of the real hits where the simulated beam hits too.", 4,
     Better::kHigher},
    {"/f1", "F1 of hits", "Harmonic mean of precision and recall.", 4, Better::kHigher},
    {"/cloud_error_m", "Point cloud error, m",
     "Mean distance to the nearest point of the other cloud, both ways.", 4, Better::kLower},
    {"/density_aware_chamfer", "Density-aware Chamfer", "From 0 (same points, equally dense) to 1.",
     4, Better::kLower},
    {"/nll_per_beam", "Neg. log-likelihood",
     "Mean −log density that the model gives the real outcome of a beam.", 4, Better::kLower},
    {"/crps_m", "CRPS of the range, m",
     "Distance between the predicted distribution of the range and the real one; a miss counts as "
     "the maximum range, so a wrong one costs many metres.",
     3, Better::kLower},
    {"/intensity/rmse", "Intensity RMSE",
     "Over the beams that hit in both, in the unit of the logs.", 4, Better::kLower},
    {"/intensity/constant/rmse", "Intensity RMSE of a constant",
     "Of the mean of the real log as the answer of every beam: the baseline.", 4, Better::kNeither},
    {"/intensity/correlation", "Intensity correlation", "Of real and simulated intensities.", 4,
     Better::kHigher},
};

const Json& scores_of(const Comparison& input, size_t k) {
  return input.scores.at("models").at(input.simulated[k].name);
}

std::optional<double> value(const Json& scores, const char* place) {
  const Json::json_pointer at(place);
  if (!scores.contains(at) || !scores.at(at).is_number()) return std::nullopt;
  return scores.at(at).get<double>();
}

std::string cell(std::optional<double> x, int digits) {
  return x ? fmt::format("{:.{}f}", *x, digits) : "n/a";
}

size_t count(const Json& scores, const char* key) { return scores.value(key, size_t(0)); }

const char* arrow_of(Better better) {
  return better == Better::kNeither ? "" : better == Better::kHigher ? "↑" : "↓";
}

// Values are compared as printed, so that those that look the same are equally good.
std::string best_of(const Metric& m, const std::vector<std::optional<double>>& values) {
  std::optional<double> best;
  for (const auto& v : values) {
    const bool higher = m.better == Better::kHigher;
    if (v && (!best || (higher ? *v > *best : *v < *best))) best = v;
  }
  return cell(best, m.digits);
}

// What the baselines are; the look-up is there where a training log is.
std::string caption_of(const Json& baselines) {
  if (baselines.empty()) return "";
  const bool trained = baselines.contains("look-up");
  return fmt::format(
      "<p class=\"caption\">The baselines need no model. Always hit: each beam returns at the "
      "median "
      "range of its ring in the {} log.{}</p>\n",
      trained ? "training" : "real",
      trained ? " Look-up: the points of the two nearest training scans are projected with the "
                "beam’s own origin, and the nearest in angle answers."
              : "");
}

std::string filled(const std::string& page, const std::map<std::string, std::string>& values) {
  const std::map<std::string, std::string> assets = {{"style", kReportStyle},
                                                     {"script", kReportScript}};
  std::string out;
  size_t at = 0;
  while (true) {
    const size_t begin = page.find("@@", at), end = page.find("@@", begin + 2);
    out += page.substr(at, begin - at);
    if (begin == std::string::npos) return out;
    const std::string key = page.substr(begin + 2, end - begin - 2);
    out += assets.count(key) ? assets.at(key) : values.at(key);
    at = end + 2;
  }
}

}  // namespace

std::string grouped(size_t n) {
  const std::string digits = std::to_string(n);
  std::string out;
  for (size_t i = 0; i < digits.size(); ++i) {
    if (i && (digits.size() - i) % 3 == 0) out += "\u202f";
    out += digits[i];
  }
  return out;
}

std::string headline_table(const Comparison& input) {
  const Json baselines = input.scores.value("baselines", Json::object());
  std::string html = "<div class=\"scroll\"><table class=\"headline\"><thead><tr><th>Metric</th>";
  for (const auto& m : input.simulated) html += fmt::format("<th>{}</th>", escaped(m.name));
  for (const auto& [name, scores] : baselines.items()) {
    html += fmt::format("<th>{}<small>baseline</small></th>", escaped(name));
  }
  html += "</tr></thead><tbody>\n";
  for (const Metric& m : kMetrics) {
    std::vector<std::optional<double>> values;
    for (size_t k = 0; k < input.simulated.size(); ++k) {
      values.push_back(value(scores_of(input, k), m.place));
    }
    for (const auto& [name, scores] : baselines.items()) values.push_back(value(scores, m.place));
    // Otherwise the score was not asked for.
    if (!scores_of(input, 0).contains(Json::json_pointer(m.place))) continue;
    const std::string best = best_of(m, values);
    html += fmt::format("<tr><th>{} <span class=\"better\">{}</span><small>{}</small></th>", m.name,
                        arrow_of(m.better), m.meaning);
    for (const auto& v : values) {
      const std::string text = cell(v, m.digits);
      const bool bold = v && values.size() > 1 && m.better != Better::kNeither && text == best;
      html += fmt::format("<td{}>{}</td>",
                          bold ? " class=\"best\""
                          : v  ? ""
                               : " class=\"none\"",
                          text);
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n" + caption_of(baselines);
}

std::string confusion_tables(const Comparison& input) {
  std::string html;
  for (size_t k = 0; k < input.simulated.size(); ++k) {
    const Json& s = scores_of(input, k);
    const double beams = double(std::max<size_t>(count(s, "beams"), 1));
    const auto box = [&](const char* key, const char* kind) {
      const double share = double(count(s, key)) / beams;
      // The root makes rare outcomes visible as well.
      return fmt::format(
          "<td class=\"{}\" style=\"--a:{:.2f}\"><b>{:.2f} %</b><small>{}</small></td>", kind,
          0.06 + 0.5 * std::sqrt(share), 100 * share, grouped(count(s, key)));
    };
    html += fmt::format(
        "<table class=\"confusion\"><caption>{}</caption><thead><tr><td></td><th>simulated "
        "hit</th><th>simulated miss</th></tr></thead><tbody><tr><th>real hit</th>{}{}</tr><tr>"
        "<th>real miss</th>{}{}</tr></tbody></table>\n",
        escaped(input.simulated[k].name), box("true_hits", "right"), box("false_misses", "wrong"),
        box("false_hits", "wrong"), box("true_misses", "right"));
  }
  return html;
}

std::string class_table(const Comparison& input, const std::string& heading) {
  if (input.simulated.empty()) return "";
  const Json classes = scores_of(input, 0).value("per_class", Json::object());
  if (classes.empty()) return "";
  std::string html = heading +
                     "<div class=\"scroll\"><table><thead><tr><th>Class</th>"
                     "<th>Beams</th>";
  for (const auto& m : input.simulated) {
    html +=
        fmt::format("<th>{0}<small>recall</small></th><th>{0}<small>packet error, m</small></th>",
                    escaped(m.name));
  }
  html += "</tr></thead><tbody>\n";
  for (const auto& [key, first] : classes.items()) {
    html += fmt::format("<tr><th>{}</th><td>{}</td>", escaped(key), grouped(count(first, "beams")));
    for (size_t k = 0; k < input.simulated.size(); ++k) {
      const Json all = scores_of(input, k).value("per_class", Json::object());
      const Json s = all.value(key, Json::object());
      html += fmt::format("<td>{}</td><td>{}</td>", cell(value(s, "/recall"), 4),
                          cell(value(s, "/packet_error_m"), 3));
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string provenance_text(const Comparison& input) {
  const Json provenance = input.scores.value("provenance", Json::object());
  return escaped(io::text_of_json(provenance, 2));
}

std::string filled_page(const std::map<std::string, std::string>& values) {
  return filled(kReportPage, values);
}

std::string filled_section(const std::map<std::string, std::string>& values) {
  return filled(kReportSection, values);
}

std::string filled_summary(const std::map<std::string, std::string>& values) {
  return filled(kSummaryPage, values);
}

std::filesystem::path write_page(const std::filesystem::path& folder, const std::string& page) {
  std::error_code failed;
  const bool made = std::filesystem::create_directories(folder, failed);
  if (failed) throw IoError(folder.string() + ": " + failed.message());
  std::filesystem::path file = folder / "index.html";
  try {
    io::write_atomically(file, page);
  } catch (const IoError&) {
    if (made) std::filesystem::remove(folder, failed);  // an empty folder is no report
    throw;
  }
  return file;
}

}  // namespace underbrush::report
