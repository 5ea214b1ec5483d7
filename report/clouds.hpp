/// \file
/// Comparisons of point clouds (`metrics::compare_clouds`), as tables and as a page.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "report/table.hpp"
#include "underbrush/metrics/clouds.hpp"

namespace underbrush::report {

/// Returns the scores side by side, and the worst regions of each log.
std::vector<Table> tables_of_clouds(const std::vector<metrics::NamedCloudScores>& clouds);
/// Writes `folder`/index.html with the tables and the distributions of ranges and heights,
/// atomically, and returns its path. `clouds` must not be empty; `provenance` is JSON.
std::filesystem::path write_cloud_report(const std::filesystem::path& folder,
                                         const std::vector<metrics::NamedCloudScores>& clouds,
                                         const std::string& provenance);

}  // namespace underbrush::report
