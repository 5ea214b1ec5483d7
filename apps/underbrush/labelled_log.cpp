#include "labelled_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "underbrush/elements/label_sets.hpp"
#include "underbrush/primitives/measure.hpp"

namespace underbrush::app {
namespace {

using elements::Class;
using elements::ClassKind;

constexpr size_t kTruePoints = 10;  // True trees with fewer returns need not be found.

}  // namespace

LabelsOfHits found_of(const primitives::LogLabels& labels) {
  LabelsOfHits out;
  out.instance = labels.object;
  out.objects = labels.objects.size();
  for (size_t k = 0; k < labels.object.size(); ++k) {
    const uint32_t object = labels.object[k];
    out.label.push_back(uint8_t(labels.ground[k] ? Class::kGround
                                : object         ? labels.objects[object - 1].label
                                                 : Class::kUnknown));
  }
  return out;
}

std::vector<primitives::Prior> priors_of(const primitives::GivenLabels& given) {
  using primitives::Prior;
  std::vector<Prior> prior;
  for (const uint32_t label : given.label) {
    prior.push_back(elements::ground_label(given.set, label) == elements::GroundLabel::kYes
                        ? Prior::kGround
                    : elements::is_vegetation(given.set, label) ? Prior::kObject
                                                                : Prior::kOther);
  }
  return prior;
}

LabelsOfHits taken_over(const primitives::GivenLabels& given, const primitives::LogLabels* labels) {
  LabelsOfHits out = labels ? found_of(*labels) : LabelsOfHits{};
  if (!given.label.empty() && given.set == "underbrush") {
    out.label.assign(given.label.begin(), given.label.end());
  }
  if (!given.instance.empty() && (given.set == "underbrush" || given.label.empty())) {
    out.instance = given.instance;
    out.objects = std::set<uint32_t>(given.instance.begin(), given.instance.end()).size();
    out.objects -= std::count(given.instance.begin(), given.instance.end(), 0u) > 0;
  }
  return out;
}

size_t put_labels(const LabelsOfHits& found, size_t next, BeamLog& chunk, LabelledCounts& out) {
  std::vector<uint8_t> label(chunk.size());
  std::vector<uint32_t> instance(chunk.size());
  const auto given = chunk.extra.find("class"), truth = chunk.extra.find(out.truth);
  out.labelled = out.score && given != chunk.extra.end();
  out.has_truth = out.score && truth != chunk.extra.end();
  const std::string& set = chunk.info.classes;
  for (size_t i = 0; i < chunk.size(); ++i) {
    ++out.beams;
    if (!chunk.is_hit(i)) continue;
    const size_t k = next++;
    label[i] = found.label[k];
    instance[i] = found.instance[k];
    const auto c = Class(label[i]);
    const bool ground = c == Class::kGround || c == Class::kGrass;
    ++out.hits;
    ++out.points[c];
    out.ground += ground;
    bool tree = true;  // Where the log does not say, every number counts as a tree's.
    if (out.labelled) {
      const uint32_t number = whole_number(given->second, i);
      const elements::GroundLabel known = elements::ground_label(set, number);
      if (known == elements::GroundLabel::kUnknown) {
        ++out.unlabelled;
      } else {
        out.ground_score.add(ground, known == elements::GroundLabel::kYes);
        out.vegetation.add(elements::kind_of(c) != ClassKind::kOther,
                           elements::is_vegetation(set, number));
      }
      tree = set == "underbrush" ? elements::kind_of(Class(number)) == ClassKind::kTree
                                 : elements::is_vegetation(set, number);
    }
    if (out.has_truth && !ground) {
      out.trees.add(elements::kind_of(c) == ClassKind::kTree ? instance[i] : 0,
                    tree ? whole_number(truth->second, i) : 0);
    }
  }
  for (const char* name : {"class", "instance"}) {
    const auto old = chunk.extra.find(name);
    if (out.score && old != chunk.extra.end()) {
      chunk.extra[std::string("given_") + name] = std::move(old->second);
    }
  }
  chunk.extra["class"] = std::move(label);
  chunk.extra["instance"] = std::move(instance);
  return next;
}

LabelledSource::LabelledSource(BeamSource& log, const LabelsOfHits& found, LabelledCounts counts)
    : log_(log), found_(found), zero_(std::move(counts)), counts_(zero_), info_(log.info()) {
  info_.classes = "underbrush";
  rewind();
}

void LabelledSource::rewind() {
  log_.rewind();
  counts_ = zero_;
  next_ = 0;
}

bool LabelledSource::next(BeamLog& chunk) {
  if (!log_.next(chunk)) return false;
  next_ = put_labels(found_, next_, chunk, counts_);
  chunk.info.classes = info_.classes;
  return true;
}

Json json_of(const LabelledCounts& o) {
  const auto number = [](double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); };
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

std::string text_of(const LabelledCounts& o, size_t objects) {
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

}  // namespace underbrush::app
