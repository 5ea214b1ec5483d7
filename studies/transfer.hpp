/// Cross-sensor transfer: its run and its thresholds.
#pragma once
#include <functional>
#include <string>

#include "studies/study.hpp"
#include "underbrush/fit/fit.hpp"
#include "underbrush/metrics/score.hpp"

namespace underbrush::studies {

/// F1 and point cloud error of the transferred model within 10 % of the natively fitted one's; a
/// better one is within.
std::vector<Check> transfer_checks(const std::string& from, const std::string& to,
                                   const metrics::Summary& transferred,
                                   const metrics::Summary& native);

/// What a test does to the model that was learnt from a lidar.
using ModelChange = std::function<void(const std::string& lidar, elements::Model& model)>;

/// The study `transfer`; `change` may be empty.
StudyResult transfer(const StudyRun& run, const ModelChange& change);

}  // namespace underbrush::studies
