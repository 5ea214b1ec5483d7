/// \file
/// The pass of `segment` over a log, which writes labels, counts, and scores against given labels.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/classes.hpp"
#include "underbrush/metrics/agreement.hpp"
#include "underbrush/metrics/instances.hpp"
#include "underbrush/primitives/segment_log.hpp"

namespace underbrush::pipeline {

/// Labels with one entry for each hit, as they are written.
struct LabelsOfHits {
  std::vector<uint8_t> label;
  std::vector<uint32_t> instance;
  size_t objects = 0;
};

/// Returns the labels that `segment_log` found.
LabelsOfHits found_of(const primitives::LogLabels& labels);

/// Counts and scores of a pass over the log.
struct LabelledCounts {
  explicit LabelledCounts(std::string truth_column = "", bool scored = false)
      : truth(std::move(truth_column)), score(scored) {}
  std::string truth;  ///< Column with the numbers of the true trees.
  bool score;         ///< Whether to score against the labels that the log has.
  size_t beams = 0, hits = 0, ground = 0, unlabelled = 0;
  bool labelled = false, has_truth = false;
  std::map<elements::Class, size_t> points;
  metrics::Agreement ground_score, vegetation;
  metrics::InstanceCounter trees;

  /// True trees with fewer than 10 returns need not be found.
  metrics::InstanceScore tree_score() const { return trees.score(10); }
};

/// Writes the labels from hit number `next` on into the columns `class` and `instance` of the
/// chunk, and counts them. If the chunk's own labels are scored against, they become `given_class`
/// and `given_instance`. Returns the number of the hit that comes next.
size_t put_labels(const LabelsOfHits& found, size_t next, BeamLog& chunk, LabelledCounts& out);

/// Source that yields a log as `segment` writes it: each chunk has its labels, and they are
/// counted. The log and the labels must outlive it.
class LabelledSource : public BeamSource {
 public:
  LabelledSource(BeamSource& log, const LabelsOfHits& found, LabelledCounts counts);
  const LogInfo& info() const override { return info_; }
  size_t size() const override { return log_.size(); }
  void rewind() override;
  bool next(BeamLog& chunk) override;
  /// Returns the counts of the rows that were read since the last `rewind`.
  const LabelledCounts& counts() const { return counts_; }

 private:
  BeamSource& log_;
  const LabelsOfHits& found_;
  LabelledCounts zero_, counts_;
  LogInfo info_;
  size_t next_ = 0;
};

}  // namespace underbrush::pipeline
