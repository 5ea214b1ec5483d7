#include "segment_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace underbrush::app {
namespace {

constexpr size_t kTruePoints = 10;  // True trees with fewer returns need not be found.

Json number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json json_of(const pipeline::LabelledCounts& o) {
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
                         {"iou", number(o.ground_score.iou())},
                         {"precision", number(o.ground_score.precision())},
                         {"recall", number(o.ground_score.recall())}};
    j["vegetation_score"] = {{"precision", number(o.vegetation.precision())},
                             {"recall", number(o.vegetation.recall())}};
  }
  if (o.has_truth) {
    const metrics::InstanceScore s = o.trees.score(kTruePoints);
    j["tree_score"] = {{"found", s.found},
                       {"truth", s.truth},
                       {"matched", s.matched},
                       {"precision", number(s.precision())},
                       {"recall", number(s.recall())},
                       {"f1", number(s.f1())},
                       {"mean_iou", s.mean_iou}};
  }
  return j;
}

std::string text_of(const pipeline::LabelledCounts& o, size_t objects) {
  std::string text =
      fmt::format("{} of {} hits are ground ({:.1f} %), {} objects\n", o.ground, o.hits,
                  100.0 * double(o.ground) / double(std::max<size_t>(1, o.hits)), objects);
  for (const auto& [c, n] : o.points) {
    text += fmt::format("  {:<19}{:>12} points\n", elements::name(c), n);
  }
  if (o.labelled && o.hits == o.unlabelled) {
    text += "  note: its column class has no label of a known set (see import --label-set)\n";
  } else if (o.labelled) {
    const metrics::Agreement& g = o.ground_score;
    text += fmt::format(
        "  ground against labels      IoU {:.4f}  precision {:.4f}  recall {:.4f}  ({} labelled, "
        "{} not)\n",
        g.iou(), g.precision(), g.recall(), o.hits - o.unlabelled, o.unlabelled);
    if (std::isfinite(o.vegetation.recall())) {
      text += fmt::format("  vegetation against labels  precision {:.4f}  recall {:.4f}\n",
                          o.vegetation.precision(), o.vegetation.recall());
    }
  }
  if (o.has_truth) {
    const metrics::InstanceScore s = o.trees.score(kTruePoints);
    if (s.truth) {
      text += fmt::format(
          "  trees against {:<12} {} found, {} true, {} matched  precision {:.3f}  recall {:.3f}  "
          "mean IoU {:.3f}\n",
          o.truth, s.found, s.truth, s.matched, s.precision(), s.recall(), s.mean_iou);
    }
  }
  return text;
}

}  // namespace

Json json_of(const pipeline::Segmentation& s, const pipeline::SegmentOptions& options,
             const std::map<std::string, size_t>& skipped) {
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

std::string text_of(const pipeline::Segmentation& s, const pipeline::SegmentOptions& options) {
  std::string text = text_of(s.counts, s.objects);
  if (s.given) {
    text += fmt::format("  labels      {} ({}), {} hits without\n", options.labels,
                        s.given->by_place ? "by place" : "by order", s.given->unmatched);
  }
  if (s.found && s.found->off_ground) {
    text += fmt::format("  left out    {} hits with no ground within 30 m: in no object\n",
                        s.found->off_ground);
  }
  return text;
}

}  // namespace underbrush::app
