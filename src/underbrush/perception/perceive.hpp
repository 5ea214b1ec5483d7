/// \file
/// A log turned into lists of objects.
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "underbrush/perception/cycles.hpp"
#include "underbrush/perception/false_positives.hpp"
#include "underbrush/perception/log_truth.hpp"
#include "underbrush/perception/object_pipeline.hpp"
#include "underbrush/perception/tracking_model.hpp"

namespace underbrush::perception {

/// The stages and options by which a log is turned into lists.
struct PerceptionSetup {
  std::optional<Rig> rig;
  CycleOptions cycles;
  /// Whether the tracking model makes the lists, from the truth, or the real pipeline.
  bool is_model = true;
  TrackingOptions model;
  PipelineOptions real;
  FalsePositiveOptions ghosts;
  uint64_t seed = 1;
};

/// Lists of objects, one for each scan.
struct PerceivedLog {
  std::vector<ObjectList> lists, truth;  ///< `truth` is empty if there is none.
  size_t points = 0;
  double seconds = 0;  ///< Duration without reading and alignment.
};

/// Turns a log into lists, and passes the cloud of each cycle to `see`, if there is one. `truth`
/// may be null for the real pipeline. Throws `std::invalid_argument` for options out of range, and
/// `DataError`.
PerceivedLog perceived(BeamSource& log, const LogTruth* truth, const PerceptionSetup& setup,
                       const std::function<void(const MergedCloud&)>& see = {});

}  // namespace underbrush::perception
