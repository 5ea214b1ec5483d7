#include <algorithm>
#include <nlohmann/json.hpp>

#include "underbrush/io/json_text.inl"
#include "underbrush/pipeline/reports_json.inl"

namespace underbrush::pipeline {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const std::optional<io::ScanClock>& clock) {
  if (!clock) return nullptr;
  return {{"step_s", clock->step_s},
          {"period_s", clock->period_s},
          {"residual_rms_s", clock->residual_rms_s},
          {"scans_fitted", clock->fitted},
          {"scans_kept", clock->kept},
          {"poses_follow", clock->poses_follow}};
}

Json json_of(const LabelledCounts& o) {
  Json j;
  j["beams"] = o.beams;
  j["hits"] = o.hits;
  j["ground"] = o.ground;
  for (const auto& [c, n] : o.points) j["points"][std::string(elements::name(c))] = n;
  if (o.labelled) {
    j["ground_score"] = {{"labelled", o.hits - o.unlabelled},
                         {"unlabelled", o.unlabelled},
                         {"true_positive", o.ground_score.true_positive},
                         {"false_positive", o.ground_score.false_positive},
                         {"false_negative", o.ground_score.false_negative},
                         {"true_negative", o.ground_score.true_negative},
                         {"iou", io::finite_or_null(o.ground_score.iou())},
                         {"precision", io::finite_or_null(o.ground_score.precision())},
                         {"recall", io::finite_or_null(o.ground_score.recall())}};
    j["vegetation_score"] = {{"precision", io::finite_or_null(o.vegetation.precision())},
                             {"recall", io::finite_or_null(o.vegetation.recall())}};
  }
  if (o.has_truth) {
    const metrics::InstanceScore s = o.tree_score();
    j["tree_score"] = {{"found", s.found},
                       {"truth", s.truth},
                       {"matched", s.matched},
                       {"precision", io::finite_or_null(s.precision())},
                       {"recall", io::finite_or_null(s.recall())},
                       {"f1", io::finite_or_null(s.f1())},
                       {"mean_iou", s.mean_iou}};
  }
  return j;
}

Json json_of(const perception::MoverScore& score) {
  const auto json = [](const perception::MarkedReturns& m) {
    return Json{{"objects", m.objects}, {"returns", m.returns}, {"marked", m.marked}};
  };
  Json j = {{"moving", Json::object()}, {"standing", Json::object()}};
  for (const auto& [name, m] : score.moving) j["moving"][name] = json(m);
  for (const auto& [name, m] : score.standing) j["standing"][name] = json(m);
  j["elsewhere"] = json(score.elsewhere);
  return j;
}

}  // namespace

Json json_of(const ImportReport& r) {
  Json j;
  j["format"] = r.format;
  j["scans"] = r.scans;
  j["beams"] = r.beams;
  j["hits"] = r.beam.hits;
  j["misses"] = r.beam.misses_recorded + r.beam.misses_inferred;
  j["misses_recorded"] = r.beam.misses_recorded;
  j["misses_inferred"] = r.beam.misses_inferred;
  j["later_returns"] = r.later_returns;
  j["unknown"] = r.beam.unknown;
  j["scans_ringed_by_elevation"] = r.beam.scans_ringed_by_elevation;
  j["scans_with_rings_renumbered"] = r.beam.scans_with_rings_renumbered;
  j["skipped"] = r.skipped;
  j["clock"] = json_of(r.clock);
  j["notes"] = r.notes;
  j["warnings"] = r.warnings;
  return j;
}

Json json_of(const MoverMarks& marks, const perception::MoverScore* score,
             const SkippedRows& skipped) {
  Json j = {{"rows", marks.mark.size()},
            {"returns", marks.returns},
            {"marked", marks.marked},
            {"skipped", skipped}};
  if (score) j["truth"] = json_of(*score);
  return j;
}

Json json_of(const Segmentation& s, const SegmentOptions& options, const SkippedRows& skipped) {
  Json j = json_of(s.counts);
  j["ground_method"] = options.search.ground.method;
  j["objects"] = s.objects;
  j["skipped"] = skipped;
  if (s.found) {
    std::map<elements::Class, size_t> objects;
    for (const auto& object : s.found->objects) ++objects[object.label];
    for (const auto& [c, n] : objects) j["classes"][std::string(elements::name(c))] = n;
    j["cell_m"] = s.found->cell_m;
    j["off_ground"] = s.found->off_ground;
    j["near"] = s.found->near;
  }
  if (s.given) {
    j["labels"] = {{"set", s.given->set},
                   {"by_place", s.given->by_place},
                   {"unmatched", s.given->unmatched},
                   {"not_numbers", s.given->not_numbers}};
  }
  return j;
}

}  // namespace underbrush::pipeline
