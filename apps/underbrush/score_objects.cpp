#include "score_objects.hpp"

#include <fmt/format.h>

#include "report/object_lists.hpp"
#include "report/report.hpp"
#include "underbrush/osi/list_file.hpp"
#include "underbrush/pipeline/reports_json.inl"

namespace underbrush::app {
namespace {

using perception::ListScore;
using perception::ObjectList;

/// Scores all lists against one reference.
std::vector<ListScore> scores_of(const std::vector<report::NamedLists>& lists,
                                 const std::vector<ObjectList>& reference) {
  std::vector<ListScore> scores;
  scores.reserve(lists.size());
  for (const report::NamedLists& l : lists)
    scores.push_back(perception::score_lists(l.lists, reference));
  return scores;
}

Json json_of_all(const std::vector<report::NamedLists>& lists,
                 const std::vector<ListScore>& scores) {
  Json j;
  for (size_t k = 0; k < lists.size(); ++k) j[lists[k].name] = pipeline::json_of(scores[k]);
  return j;
}

std::vector<std::string> names_of(const std::vector<report::NamedLists>& lists) {
  std::vector<std::string> names;
  names.reserve(lists.size());
  for (const report::NamedLists& l : lists) names.push_back(l.name);
  return names;
}

}  // namespace

void score_objects(const Verb& verb, const ObjectScoreArguments& a) {
  const report::NamedLists real{"real", osi::read_lists(a.real)};
  std::vector<std::filesystem::path> inputs{a.real};
  std::vector<report::NamedLists> simulated;
  for (size_t k = 0; k < a.simulated.size(); ++k) {
    simulated.push_back({a.names[k], osi::read_lists(a.simulated[k])});
    inputs.emplace_back(a.simulated[k]);
  }
  if (!a.report.empty()) report::check_report_output(a.report);
  std::vector<report::Table> tables;
  Json j;
  const std::vector<ListScore> against_real = scores_of(simulated, real.lists);
  tables.push_back(report::table_of("the real lists", names_of(simulated), against_real));
  j["against_real"] = json_of_all(simulated, against_real);
  report::NamedLists reference = real;
  std::vector<report::NamedLists> shown = simulated;
  if (!a.truth.empty()) {
    inputs.emplace_back(a.truth);
    reference = {"truth", osi::read_lists(a.truth)};
    shown.insert(shown.begin(), real);
    const std::vector<ListScore> against_truth = scores_of(shown, reference.lists);
    tables.push_back(report::table_of("the truth", names_of(shown), against_truth));
    j["against_truth"] = json_of_all(shown, against_truth);
    for (const report::NamedLists& s : simulated) {
      const auto rows = perception::compare_lists(s.lists, real.lists, reference.lists);
      tables.push_back(report::table_of(rows, s.name, "real"));
      j["normalised_rmse"][s.name] = pipeline::json_of(rows);
    }
  }
  std::string text;
  for (const report::Table& table : tables) text += report::text_of(table) + "\n";
  const std::string origin = provenance(verb, inputs);
  if (!a.report.empty()) {
    text +=
        "report: " +
        report::write_list_report(a.report, "Lists of objects", reference, shown, tables, origin)
            .string() +
        "\n";
  }
  verb.report(j, text);
}

}  // namespace underbrush::app
