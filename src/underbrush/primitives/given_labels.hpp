/// \file
/// Labels that people or other programs gave to the points of a log.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::primitives {

/// How a file of labels is read.
struct GivenLabelOptions {
  /// What its numbers mean: a label set; empty = "semantickitti" for .label files, else what the
  /// file says if it is a log of ours, else what the log says, else "underbrush".
  std::string set;
  double tolerance_m = 0.02;  ///< A point of the file and a hit are the same up to this distance.
};

/// One entry a hit, in the log's order.
struct GivenLabels {
  std::vector<uint32_t> label;     ///< In the numbers of `set`; empty if the file has none.
  std::vector<uint32_t> instance;  ///< 0 = none; empty if the file has none.
  std::string set;
  bool by_place = false;   ///< Points were matched by place, not by order.
  size_t unmatched = 0;    ///< Hits without a point within the tolerance: label and instance 0.
  size_t not_numbers = 0;  ///< Values that are NaN (merged clouds have them): taken as 0.
};

/// Reads labels for the hits of `log`.
///
/// - `.label` (SemanticKITTI: uint32, label in the low, instance in the high 16 bits): one a beam,
/// or
///   one a hit.
/// - a point file (PLY, PCD, CSV, …) with a column `class` (or `classification`, `label`) or
///   `instance`, or both, letter case and `scalar_` ignored: by order if it has a row a beam or a
///   hit and its x, y, z are theirs, else by place, each hit taking the nearest point. So points
///   may be shuffled or left out.
///
/// Throws `FormatError` where the file has no such column, a value is not a whole number from 0 to
/// 2³²−1, a label is not in the set, or nothing of it lies at the log's points.
GivenLabels read_given_labels(const std::filesystem::path& file, BeamSource& log,
                              const GivenLabelOptions& options = {});

}  // namespace underbrush::primitives
