/// The pass of `segment` over a log: puts labels in, counts, and scores against those given.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/classes.hpp"
#include "underbrush/metrics/agreement.hpp"
#include "underbrush/metrics/instances.hpp"
#include "underbrush/primitives/segment_log.hpp"
#include "cli/verb.hpp"

namespace underbrush::app {

/// Labels of each hit as they are written.
struct LabelsOfHits {
  std::vector<uint8_t> label;
  std::vector<uint32_t> instance;
  size_t objects = 0;
};

/// Those that `segment_log` found.
LabelsOfHits found_of(const primitives::LogLabels& labels);

/// What a pass over the log gives.
struct LabelledCounts {
  LabelledCounts(std::string truth_column, bool scored)
      : truth(std::move(truth_column)), score(scored) {}
  std::string truth;  ///< Column with the true trees' numbers.
  bool score;         ///< Against the labels that the log has.
  size_t beams = 0, hits = 0, ground = 0, unlabelled = 0;
  bool labelled = false, has_truth = false;
  std::map<elements::Class, size_t> points;
  metrics::Agreement ground_score, vegetation;
  metrics::InstanceCounter trees;
};

/// Puts the labels from hit number `next` on into the chunk's columns `class` and `instance`, and
/// counts; those that it had, where they are scored against, become `given_class` and
/// `given_instance`. Returns the number of the hit that comes next.
size_t put_labels(const LabelsOfHits& found, size_t next, BeamLog& chunk, LabelledCounts& out);

/// A log as `segment` writes it: each chunk with labels put in, and counted. Must not outlive what
/// it is made of.
class LabelledSource : public BeamSource {
 public:
  LabelledSource(BeamSource& log, const LabelsOfHits& found, LabelledCounts counts);
  const LogInfo& info() const override { return info_; }
  size_t size() const override { return log_.size(); }
  void rewind() override;
  bool next(BeamLog& chunk) override;
  /// Of what was read since the last `rewind`.
  const LabelledCounts& counts() const { return counts_; }

 private:
  BeamSource& log_;
  const LabelsOfHits& found_;
  LabelledCounts zero_, counts_;
  LogInfo info_;
  size_t next_ = 0;
};

Json json_of(const LabelledCounts& counts);
std::string text_of(const LabelledCounts& counts, size_t objects);

}  // namespace underbrush::app
