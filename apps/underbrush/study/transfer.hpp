/// The thresholds of cross-sensor transfer.
#pragma once
#include "study/study.hpp"
#include "underbrush/fit/fit.hpp"
#include "underbrush/metrics/score.hpp"

namespace underbrush::app {

/// F1 and point cloud error of the transferred model within 10 % of the natively fitted one's; a
/// better one is within.
std::vector<Check> transfer_checks(const std::string& from, const std::string& to,
                                   const metrics::Summary& transferred,
                                   const metrics::Summary& native);

}  // namespace underbrush::app
