/// \file
/// The vegetation of a cloud, for the score of [goodin24].
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::metrics {

/// Points of vegetation, and how they were selected.
struct LeafCloud {
  std::vector<Vec3f> points;  ///< m, z up, relative to a point of the cloud.
  std::string by;             ///< `labels`, `not ground` or `all points`.
  size_t first_scan = 0;      ///< Number of points at the beginning that are of a log's first scan.
};

/// Returns the vegetation in a file. In a log it consists of the hits 3 to 25 m from their sensor
/// that the labels (extra column `class`) call trees or shrubs; without labels, of those that are
/// not ground by the segmentation of `fit`; with `all`, of every hit. In another point file (PLY,
/// PCD, CSV, …) it is every point except (0, 0, 0), which stands for a miss. Throws `FormatError`.
LeafCloud leaf_cloud(const std::filesystem::path& file, bool all = false);

/// Returns the finite points of a point file. Throws `FormatError`, also where x, y or z is
/// missing.
std::vector<Vec3> points_of(const std::filesystem::path& file);

}  // namespace underbrush::metrics
