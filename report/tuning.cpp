#include "report/tuning.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "report/page.hpp"
#include "report/summary_page.hpp"
#include "report/svg_plot.hpp"
#include "report/table.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_text.inl"

namespace underbrush::report {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
using optimize::Evaluation;

constexpr const char *kBest = "#c33", *kTried = "#36c";

std::string rounded(double x) { return std::isfinite(x) ? fmt::format("{:.4g}", x) : "n/a"; }

bool at_edge(const optimize::Parameter& p, double value) {
  return value == p.low || value == p.high;
}

Table table_of(const Tuning& t) {
  Table table{fmt::format("{} evaluations of {}", t.evaluations.size(), t.objective),
              t.what,
              {"", "start", "tuned", "range"},
              {}};
  for (size_t k = 0; k < t.parameters.size(); ++k) {
    const optimize::Parameter& p = t.parameters[k];
    table.rows.push_back({p.name, rounded(t.start().value[k]), rounded(t.tuned().value[k]),
                          fmt::format("{:g} to {:g}{}", p.low, p.high,
                                      at_edge(p, t.tuned().value[k]) ? ", at its end" : "")});
  }
  table.rows.push_back({"objective", rounded(t.start().outcome.objective),
                        rounded(t.tuned().outcome.objective), ""});
  for (const auto& [name, value] : t.start().outcome.score) {
    table.rows.push_back({name, rounded(value), rounded(t.tuned().outcome.score.at(name)), ""});
  }
  return table;
}

Table history_of(const Tuning& t) {
  Table table{"What was tried", "In order; the least objective is taken.", {"#"}, {}};
  for (const optimize::Parameter& p : t.parameters) table.head.push_back(p.name);
  table.head.emplace_back("objective");
  for (size_t i = 0; i < t.evaluations.size(); ++i) {
    table.rows.push_back({std::to_string(i + 1)});
    for (const double v : t.evaluations[i].value) table.rows.back().push_back(rounded(v));
    table.rows.back().push_back(rounded(t.evaluations[i].outcome.objective));
  }
  return table;
}

std::string curve_of(const Tuning& t) {
  SvgPlot::Points tried, best;
  std::vector<double> objective;
  for (const Evaluation& e : t.evaluations) {
    const double x = double(objective.size() + 1);
    objective.push_back(e.outcome.objective);
    tried.emplace_back(x, e.outcome.objective);
    best.emplace_back(x, *std::min_element(objective.begin(), objective.end()));
  }
  // The worst evaluations would hide the rest of the curve.
  std::sort(objective.begin(), objective.end());
  const double low = objective.front(), first = t.start().outcome.objective;
  const double high = std::max(first, objective[objective.size() * 3 / 4]);
  const double room = std::max(0.1 * (high - low), 1e-3 * std::abs(low) + 1e-12);
  for (auto& [x, y] : tried) y = std::min(y, high + room);
  SvgPlot plot("Objective by evaluation: tried (blue; at the top: beyond it) and best so far (red)",
               "evaluation", t.objective);
  plot.x_axis(0, double(t.evaluations.size() + 1));
  plot.y_axis(low - room, high + room);
  plot.line(best, kBest);
  plot.dots(tried, kTried, 5);
  return plot.svg();
}

void emit(YAML::Emitter& out, const Json& value) {
  if (value.is_array()) {
    out << YAML::Flow << YAML::BeginSeq;
    for (const Json& item : value) emit(out, item);
    out << YAML::EndSeq;
  } else if (value.is_string()) {
    out << value.get<std::string>();
  } else {
    out << io::text_of_json(value);
  }
}

}  // namespace

Json json_of(const Tuning& t) {
  Json j;
  const auto scores = [](const Evaluation& e) {
    Json s{{"objective", e.outcome.objective}};
    for (const auto& [name, value] : e.outcome.score) s[name] = value;
    return s;
  };
  j["objective"] = t.objective;
  j["start"] = scores(t.start());
  j["tuned"] = scores(t.tuned());
  for (size_t k = 0; k < t.parameters.size(); ++k) {
    const optimize::Parameter& p = t.parameters[k];
    j["parameters"][p.name] = {{"start", t.start().value[k]},
                               {"tuned", t.tuned().value[k]},
                               {"low", p.low},
                               {"high", p.high},
                               {"at_edge", at_edge(p, t.tuned().value[k])}};
  }
  j["fixed"] = t.fixed;
  for (const Evaluation& e : t.evaluations) {
    j["evaluations"].push_back({{"value", e.value}, {"objective", e.outcome.objective}});
  }
  j["provenance"] = io::json_of_text(t.provenance);
  return j;
}

std::string text_of(const Tuning& t) {
  std::string text = text_of(table_of(t)) + t.what + "\n";
  if (&t.tuned() == &t.start()) text += "  warning     nothing tried was better than the start\n";
  return text;
}

std::string line_of(const Tuning& t, std::span<const Evaluation> so_far, size_t budget) {
  const Evaluation& e = so_far.back();
  std::string line =
      fmt::format("{}/{} {:.4f} (best {:.4f})", so_far.size(), budget, e.outcome.objective,
                  so_far[optimize::best_of(so_far)].outcome.objective);
  for (size_t k = 0; k < t.parameters.size(); ++k) {
    line += fmt::format(" {}={:g}", t.parameters[k].name, e.value[k]);
  }
  return line;
}

void write_config(const fs::path& path, const Tuning& t) {
  Json options = t.fixed;
  for (size_t k = 0; k < t.parameters.size(); ++k) {
    const std::string& name = t.parameters[k].name;
    const double value = t.tuned().value[k];
    if (t.densities) {
      options["class-density"].push_back(fmt::format("{}={}", name, value));
    } else {
      options[name] = io::json_of_text(fmt::format("{}", value));
    }
  }
  YAML::Emitter yaml;
  yaml << YAML::BeginMap;
  for (const auto& [name, value] : options.items()) {
    yaml << YAML::Key << name << YAML::Value;
    emit(yaml, value);
  }
  yaml << YAML::EndMap;
  io::write_atomically(path, [&](const fs::path& temporary) {
    std::ofstream out(temporary);
    out << fmt::format(
        "# Tuned on {}: {} {:.6g} at the start, {:.6g} with these.\n"
        "#   underbrush {} --config {}\n# {}\n{}\n",
        t.log, t.objective, t.start().outcome.objective, t.tuned().outcome.objective,
        t.densities ? "compose ANNOTATION PRIMITIVES -o SCENE" : "fit LOG -o MODEL",
        path.filename().string(), t.provenance, yaml.c_str());
    if (!out.flush()) throw IoError(path.string() + ": cannot write");
  });
}

std::string sentence_on(const optimize::SliceFacts& slice, const optimize::SliceOptions& cut,
                        bool scene) {
  const size_t judge = slice.judging_beams;
  const std::string scans =
      fmt::format("{} scans from {:g} to {:g} s: ", slice.scans, cut.from_s, cut.to_s);
  if (scene) {
    return scans + fmt::format("{} beams judge the composed scene.", slice.fitted_beams + judge);
  }
  return scans + fmt::format("{} beams fitted, {} beams ({}) judge.", slice.fitted_beams, judge,
                             slice.by_scan ? fmt::format("every {}th scan", cut.one_in)
                                           : fmt::format("one group of beams in {}", cut.one_in));
}

fs::path write_tuning_report(const fs::path& folder, const Tuning& t) {
  const double from = t.start().outcome.objective, to = t.tuned().outcome.objective;
  return write_summary_page(
      folder, {.title = "Tuning on " + fs::path(t.log).filename().string(),
               .lead = t.what,
               .verdict = to < from ? fmt::format("{} from {:.4f} to {:.4f}", t.objective, from, to)
                                    : "nothing tried was better than the start",
               .asked = "<p>" + escaped(io::text_of_json(t.fixed)) + "</p>\n",
               .body = html_of(table_of(t)) + "<figure>\n" + curve_of(t) + "</figure>\n" +
                       html_of(history_of(t)),
               .provenance = t.provenance});
}

}  // namespace underbrush::report
