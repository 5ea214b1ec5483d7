#include "underbrush/pipeline/labelled_log.hpp"

#include "underbrush/elements/label_sets.hpp"

namespace underbrush::pipeline {
namespace {

using elements::Class;
using elements::ClassKind;

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

}  // namespace underbrush::pipeline
