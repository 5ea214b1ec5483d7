// The tables, figures and verdict of the primitives study.
#include <fmt/format.h>

#include <cmath>

#include "studies/primitives.hpp"
#include "underbrush/io/json_text.inl"

namespace underbrush::studies {
namespace {

using metrics::Summary;

/// A column of the table.
struct Figure {
  const char* name;
  const char* key;
  double Summary::*value;
  int digits;
};
constexpr Figure kFigures[] = {
    {"point cloud error, m", "cloud_error_m", &Summary::cloud_error_m, 3},
    {"mean packet error, m", "packet_error_m", &Summary::packet_error_m, 3},
    {"precision", "precision", &Summary::precision, 4},
    {"recall", "recall", &Summary::recall, 4},
    {"F1", "f1", &Summary::f1, 4},
    {"informedness", "informedness", &Summary::informedness, 3},
    {"F1 of misses", "f1_of_misses", &Summary::f1_of_misses, 3},
    {"capped error, m", "capped_error_m", &Summary::capped_error_m, 3},
    {"median range error, m", "median_range_error_m", &Summary::median_range_error_m, 3}};

std::vector<double> values_of(std::span<const PairOutcome> outcomes, const std::string& row,
                              double Summary::*value) {
  std::vector<double> out;
  for (const PairOutcome& o : outcomes) out.push_back(o.score.at(row).all.*value);
  return out;
}

/// Writes mean ± half the interval of the mean, or ± standard deviation.
std::string text_of(const Spread& s, int digits, bool confident) {
  return fmt::format("{:.{}f} ± {:.{}f}", s.mean, digits, confident ? s.reach : s.sd, digits);
}

report::Table table_two(const std::string& where, std::span<const PairOutcome> outcomes,
                        bool confident) {
  report::Table table{
      fmt::format("Table II: {}", where),
      fmt::format("Mean over {} pairs ± {}. geospecific: fitted to the test log itself, the "
                  "ceiling; replay: the nearest training scan, the floor; always hit: every beam "
                  "returns at the median range of its ring in the training log.",
                  outcomes.size(),
                  confident ? "the reach of the 95 % interval of the mean"
                            : "standard deviation over the pairs, which overlap"),
      {"simulator"},
      {{"published, primitives", "0.48", "2.9", "0.57", "0.85", "0.68", "", "", "", ""},
       {"published, meshes", "0.55", "3.11", "0.58", "0.75", "0.65", "", "", "", ""}}};
  for (const Figure& f : kFigures) table.head.push_back(f.name);
  for (const std::string& row : outcomes[0].rows) {
    table.rows.push_back({row});
    for (const Figure& f : kFigures) {
      table.rows.back().push_back(
          text_of(spread_of(values_of(outcomes, row, f.value)), f.digits, confident));
    }
  }
  return table;
}

report::Table pair_table(const std::string& where, std::span<const PairOutcome> outcomes) {
  report::Table table{fmt::format("Pair by pair: {}", where),
                      "Of each figure: the rows of the table above, in order. Objects: of the "
                      "annotation, those left out in brackets. Boxes: mean distance between those "
                      "asked for and those placed, of the rows that are composed.",
                      {"train and test", "cloud error, m", "packet error, m", "F1", "primitives",
                       "objects", "boxes, m"},
                      {}};
  for (const PairOutcome& o : outcomes) {
    const auto each = [&](double Summary::*value, int digits) {
      std::vector<std::string> text;
      for (const std::string& row : o.rows) {
        text.push_back(fmt::format("{:.{}f}", o.score.at(row).all.*value, digits));
      }
      return fmt::format("{}", fmt::join(text, " | "));
    };
    table.rows.push_back({o.name, each(&Summary::cloud_error_m, 3),
                          each(&Summary::packet_error_m, 2), each(&Summary::f1, 4),
                          std::to_string(o.primitives),
                          fmt::format("{} ({})", o.objects, o.left_out),
                          fmt::format("{:.2f}", fmt::join(o.box_distance_m, " | "))});
  }
  return table;
}

report::Table class_table(const std::string& where, std::span<const PairOutcome> outcomes) {
  const std::string& baseline = outcomes[0].rows[1];
  report::Table table{
      fmt::format("By class of the real return: {}", where),
      fmt::format("Means over the pairs that have the class; primitives | {}.", baseline),
      {"class", "beams", "cloud error, m", "packet error, m", "recall"},
      {}};
  for (const auto label : elements::kClassNames) {
    const std::string name(label);
    double sum[3][2] = {};
    size_t beams = 0, pairs = 0;
    for (const PairOutcome& o : outcomes) {
      const auto& owns = o.score.at("primitives").per_class;
      const auto own = owns.find(name), other = o.score.at(baseline).per_class.find(name);
      if (own == owns.end()) continue;
      beams += own->second.beams;
      const Summary* of[2] = {&own->second, &other->second};
      if (!std::isfinite(of[0]->packet_error_m + of[1]->packet_error_m)) continue;
      ++pairs;
      for (int k = 0; k < 2; ++k) {
        sum[0][k] += of[k]->cloud_error_m;
        sum[1][k] += of[k]->packet_error_m;
        sum[2][k] += of[k]->recall;
      }
    }
    if (pairs == 0) continue;
    table.rows.push_back({name, std::to_string(beams)});
    for (const auto& s : sum) {
      table.rows.back().push_back(
          fmt::format("{:.3f} | {:.3f}", s[0] / double(pairs), s[1] / double(pairs)));
    }
  }
  return table;
}

Json json_of(std::span<const PairOutcome> outcomes) {
  Json j;
  for (const std::string& row : outcomes[0].rows) {
    for (const Figure& f : kFigures) {
      const Spread s = spread_of(values_of(outcomes, row, f.value));
      j["mean"][row][f.key] = {{"mean", io::finite_or_null(s.mean)},
                               {"sd", io::finite_or_null(s.sd)},
                               {"reach_95", io::finite_or_null(s.reach)}};
    }
  }
  for (const PairOutcome& o : outcomes) {
    Json one;
    one["name"] = o.name;
    one["train_beams"] = o.train_beams;
    one["test_beams"] = o.test_beams;
    one["primitive_count"] = o.primitives;
    one["primitives_seen_by_both"] = o.seen_by_both;
    one["primitives_of_shared_plants"] = o.shared_plants;
    one["objects"] = o.objects;
    one["objects_left_out"] = o.left_out;
    for (const std::string& row : outcomes[0].rows) {
      for (const Figure& f : kFigures)
        one[row][f.key] = io::finite_or_null(o.score.at(row).all.*f.value);
      for (const auto& [label, s] : o.score.at(row).per_class) {
        one["classes"][label][row] = {{"beams", s.beams},
                                      {"packet_error_m", io::finite_or_null(s.packet_error_m)},
                                      {"cloud_error_m", io::finite_or_null(s.cloud_error_m)},
                                      {"recall", io::finite_or_null(s.recall)}};
      }
    }
    j["pairs"].push_back(std::move(one));
  }
  return j;
}

}  // namespace

Spread spread_of(std::span<const double> values) {
  const double n = double(values.size());
  Spread s{0, NAN, NAN};
  for (const double v : values) s.mean += v / n;
  if (values.size() < 2) return s;
  double squares = 0;
  for (const double v : values) squares += (v - s.mean) * (v - s.mean);
  s.sd = std::sqrt(squares / (n - 1));
  // The 97.5 % point of Student's t is tabulated up to ν = 4; beyond, it is expanded about the
  // normal's.
  constexpr double kFirst[] = {12.7062, 4.3027, 3.1824, 2.7764};
  constexpr double kZ = 1.959964, kZ3 = kZ * kZ * kZ, kZ5 = kZ3 * kZ * kZ, kZ7 = kZ5 * kZ * kZ;
  const double nu = n - 1;
  const double t = nu <= 4 ? kFirst[size_t(nu) - 1]
                           : kZ + (kZ3 + kZ) / (4 * nu) +
                                 (5 * kZ5 + 16 * kZ3 + 3 * kZ) / (96 * nu * nu) +
                                 (3 * kZ7 + 19 * kZ5 + 17 * kZ3 - 15 * kZ) / (384 * nu * nu * nu);
  s.reach = t * s.sd / std::sqrt(n);
  return s;
}

std::vector<Check> primitive_checks(const std::string& where, std::span<const PairOutcome> outcomes,
                                    bool confident) {
  struct Margin {
    const char* name;
    double Summary::*value;
    double margin, sign;
  };
  constexpr Margin kMargins[] = {{"point cloud error", &Summary::cloud_error_m, 0.55 - 0.48, 1},
                                 {"packet error", &Summary::packet_error_m, 3.11 - 2.9, 1},
                                 {"F1", &Summary::f1, 0.68 - 0.65, -1}};
  std::vector<Check> checks;
  for (const Margin& m : kMargins) {
    std::vector<double> gain;
    for (const PairOutcome& o : outcomes) {
      gain.push_back(m.sign *
                     (o.score.at(o.rows[1]).all.*m.value - o.score.at("primitives").all.*m.value));
    }
    const Spread s = spread_of(gain);
    checks.push_back(
        {fmt::format("{}: gain of primitives over {} in {}{}", where, outcomes[0].rows[1], m.name,
                     confident ? ", lower end of its 95 % interval" : ""),
         confident ? s.mean - s.reach : s.mean, m.margin, false});
  }
  return checks;
}

void add_outcomes(const std::string& where, const std::vector<PairOutcome>& outcomes,
                  bool confident, StudyResult& result) {
  result.tables.push_back(table_two(where, outcomes, confident));
  result.tables.push_back(pair_table(where, outcomes));
  result.tables.push_back(class_table(where, outcomes));
  result.figures[where] = json_of(outcomes);
  for (const Check& c : primitive_checks(where, outcomes, confident)) result.checks.push_back(c);
  for (const PairOutcome& o : outcomes) result.pictures += o.pictures;
}

}  // namespace underbrush::studies
