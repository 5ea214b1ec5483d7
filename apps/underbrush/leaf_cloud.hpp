/// The vegetation of a cloud, for the score of [goodin24].
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::app {

/// Points of vegetation, and how they were told.
struct LeafCloud {
  std::vector<Vec3f> points;  ///< z up, m, from a point of the cloud.
  std::string by;             ///< `labels`, `not ground` or `all points`.
  size_t first_scan = 0;      ///< So many, the first ones, are of a log's first scan.
};

/// Of a log, the hits 3 to 25 m from their sensor that its labels (extra column `class`) call trees
/// or shrubs; without labels those that are not ground, as `fit` tells it. Of another point file
/// (PLY, PCD, CSV, …) every point but (0, 0, 0), which stands for a miss; with `all` every hit of a
/// log. Throws `FormatError`.
LeafCloud leaf_cloud(const std::filesystem::path& file, bool all = false);

/// The points of a point file that are finite. Throws `FormatError`, also without x, y and z.
std::vector<Vec3> points_of(const std::filesystem::path& file);

}  // namespace underbrush::app
