#include "report/object_lists.hpp"

#include <fmt/format.h>

#include <cmath>

namespace underbrush::report {
namespace {

using perception::ComparedObject;
using perception::kComparedValues;
using perception::ListScore;
using perception::ValueErrors;

double rate(const ListScore& s) { return double(s.found) / double(std::max<size_t>(s.objects, 1)); }

}  // namespace

Table table_of(const std::string& reference, std::span<const std::string> names,
               std::span<const ListScore> scores) {
  Table table{"Lists against " + reference,
              "Found: share of the reference's objects. Position: mean distance of the "
              "centres seen from above. OSPA: cut-off 10 m, order 1.",
              {"value"},
              {}};
  table.head.insert(table.head.end(), names.begin(), names.end());
  const auto row = [&](const std::string& name, const auto& value) {
    std::vector<std::string> cells{name};
    for (const ListScore& s : scores) cells.push_back(value(s));
    table.rows.push_back(std::move(cells));
  };
  row("objects", [](const ListScore& s) { return std::to_string(s.objects); });
  row("found, %", [](const ListScore& s) { return fmt::format("{:.1f}", 100 * rate(s)); });
  size_t bins = 0;
  for (const ListScore& s : scores) bins = std::max(bins, s.by_range.size());
  for (size_t b = 0; b < bins; ++b) {
    const auto found = [b](const ListScore& s) -> std::string {
      if (b >= s.by_range.size() || s.by_range[b].objects == 0) return "-";
      return fmt::format("{:.1f} of {}",
                         100.0 * double(s.by_range[b].found) / double(s.by_range[b].objects),
                         s.by_range[b].objects);
    };
    row(fmt::format("  from {} m, %", 10 * b), found);
  }
  row("not in the reference", [](const ListScore& s) { return std::to_string(s.unmatched); });
  row("changes of id", [](const ListScore& s) { return std::to_string(s.switches); });
  row("position, m", [](const ListScore& s) { return fmt::format("{:.3f}", s.position_mean_m); });
  row("position, RMS, m",
      [](const ListScore& s) { return fmt::format("{:.3f}", s.position_rms_m); });
  row("heading, deg",
      [](const ListScore& s) { return fmt::format("{:.1f}", s.yaw_mean_rad * 180 / M_PI); });
  row("OSPA, m", [](const ListScore& s) { return fmt::format("{:.3f}", s.ospa_m); });
  row("HOTA", [](const ListScore& s) { return fmt::format("{:.3f}", s.hota.hota); });
  row("  of detection", [](const ListScore& s) { return fmt::format("{:.3f}", s.hota.detection); });
  row("  of association",
      [](const ListScore& s) { return fmt::format("{:.3f}", s.hota.association); });
  return table;
}

Table table_of(std::span<const ComparedObject> objects, const std::string& simulated,
               const std::string& real) {
  Table table{"Normalised RMSE, " + simulated + " and " + real,
              "RMSE of two lists over the absolute value of the truth at the first time "
              "step, by value and object, as [rosenberger20] Table 1. Cycles: those in "
              "which both lists have the object.",
              {"object", "lists", "cycles"},
              {}};
  for (const char* value : kComparedValues) table.head.emplace_back(value);
  for (const ComparedObject& o : objects) {
    const std::pair<std::string, const ValueErrors*> rows[] = {
        {fmt::format("{}/{}", simulated, real), &o.simulated_real},
        {simulated + "/truth", &o.simulated_truth},
        {real + "/truth", &o.real_truth}};
    for (const auto& [name, errors] : rows) {
      std::vector<std::string> cells{fmt::format("{} {}", perception::name(o.label), o.id), name,
                                     std::to_string(errors->cycles)};
      for (const double x : errors->normalised) {
        cells.push_back(std::isfinite(x) ? fmt::format("{:.4f}", x) : "-");
      }
      table.rows.push_back(std::move(cells));
    }
  }
  return table;
}

}  // namespace underbrush::report
