/// The study of cross-sensor transfer, and its thresholds.
#pragma once
#include <functional>
#include <string>

#include "studies/study.hpp"
#include "underbrush/metrics/score.hpp"

namespace underbrush::studies {

/// Returns the checks that F1 and point cloud error of the transferred model are within 10 % of
/// those of the natively fitted one; a better one passes.
std::vector<Check> transfer_checks(const std::string& from, const std::string& to,
                                   const metrics::Summary& transferred,
                                   const metrics::Summary& native);

/// A change that a test makes to the model learnt from a lidar.
using ModelChange = std::function<void(const std::string& lidar, elements::Model& model)>;

/// Runs the study `transfer`; `change` may be empty.
StudyResult transfer(const StudyRun& run, const ModelChange& change);

}  // namespace underbrush::studies
