#include "perceive_report.hpp"

#include "report/object_lists.hpp"
#include "underbrush/perception/grid_file.hpp"

namespace underbrush::app {
namespace {

using perception::CellLabel;

Json json_of(const pipeline::GridSummary& g) {
  const auto area = [&](CellLabel label) { return g.area_m2[size_t(label)]; };
  return {{"cycles", g.cycles},
          {"free_m2", area(CellLabel::kFree)},
          {"permeable_m2", area(CellLabel::kPermeable)},
          {"solid_m2", area(CellLabel::kSolid)},
          {"unknown_m2", area(CellLabel::kUnknown)},
          {"seconds", g.seconds}};
}

}  // namespace

Json json_of(const pipeline::Perceived& perceived) {
  const perception::PerceivedLog& p = perceived.log;
  Json j;
  j["cycles"] = p.lists.size();
  j["points"] = p.points;
  size_t objects = 0;
  for (const auto& list : p.lists) objects += list.objects.size();
  j["objects"] = objects;
  j["seconds"] = p.seconds;
  if (!p.truth.empty()) {
    j["truth"] = report::json_of_list_score(perception::score_lists(p.lists, p.truth));
  }
  if (perceived.grid) j["grid"] = json_of(*perceived.grid);
  return j;
}

}  // namespace underbrush::app
