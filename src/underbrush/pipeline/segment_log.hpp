/// \file
/// The verb `segment`: a log in, the same log with the classes and objects of its hits out.
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "underbrush/core/option.hpp"
#include "underbrush/pipeline/labelled_log.hpp"
#include "underbrush/primitives/given_labels.hpp"

namespace underbrush::pipeline {

/// The options of `segment`.
struct SegmentOptions {
  std::string labels;              ///< File from which labels are taken; "" = none.
  std::string label_set;           ///< The set of the file's numbers (`GivenLabelOptions`).
  std::string truth = "instance";  ///< Column with the numbers of the true trees.
  primitives::SegmentLogOptions search;
};

/// The options of `segment`.
std::span<const Option<SegmentOptions>> segment_options();

/// The result of `segment_log`.
struct Segmentation {
  LabelledCounts counts;
  size_t objects = 0;
  std::optional<primitives::LogLabels> found;    ///< Absent if all labels were given.
  std::optional<primitives::GivenLabels> given;  ///< Present with `SegmentOptions::labels`.
};

/// Labels the hits of a log and passes the labelled log to `write`, which reads it to its end; with
/// an empty `write` it is only counted. Labels from a file go before those that are found, and the
/// log's own labels are scored against only without such a file. `progress(stage, done, total)` may
/// be empty. Throws `FormatError` for a file of labels, and `std::invalid_argument` for options out
/// of range.
Segmentation segment_log(BeamSource& log, const SegmentOptions& options,
                         const std::function<void(BeamSource&)>& write,
                         const primitives::SegmentProgress& progress = {});

}  // namespace underbrush::pipeline
