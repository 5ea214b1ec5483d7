/// \file
/// Labels that people or other programs gave to the points of a log.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::primitives {

/// Options of `read_given_labels`.
struct GivenLabelOptions {
  /// The label set that gives the numbers their meaning. If empty, it is "semantickitti" for .label
  /// files. For other files it is the set that the file names if it is a log of ours, else the set
  /// that the log names, else "underbrush".
  std::string set;
  double tolerance_m = 0.02;  ///< m; a point of the file and a hit this near to each other are the
                              ///< same point.
};

/// Labels with one entry for each hit, in the log's order.
struct GivenLabels {
  std::vector<uint32_t> label;     ///< In the numbers of `set`; empty if the file has no labels.
  std::vector<uint32_t> instance;  ///< 0 = none; empty if the file has no instances.
  std::string set;
  bool by_place = false;   ///< Whether points were matched by place instead of by order.
  size_t unmatched = 0;    ///< Hits without a point within the tolerance; their label and instance
                           ///< are 0.
  size_t not_numbers = 0;  ///< Values that are NaN, as in merged clouds; they are read as 0.
};

/// Reads the labels of the hits of `log` from a file of one of two kinds.
///
/// - `.label` (SemanticKITTI: uint32, label in the low, instance in the high 16 bits), with an
///   entry for each beam or for each hit.
/// - A point file (PLY, PCD, CSV, …) with a column `class` (or `classification`, `label`) or
///   `instance`, or both; letter case and `scalar_` are ignored. Rows are matched by order if there
///   is one for each beam or hit and their x, y, z agree, else by place, where each hit takes the
///   nearest point. Points may therefore be shuffled or left out.
///
/// Throws `FormatError` where the file has no such column, a value is not a whole number from 0 to
/// 2³²−1, a label is not in the set, or no point lies at the log's points.
GivenLabels read_given_labels(const std::filesystem::path& file, BeamSource& log,
                              const GivenLabelOptions& options = {});

}  // namespace underbrush::primitives
