/// \file
/// Which rows of poses and times belong to the scans of a folder, and in which unit.
#pragma once
#include <string>
#include <vector>

#include "underbrush/io/scan_names.hpp"
#include "underbrush/io/scan_placing.hpp"

namespace underbrush::io {

/// Brings the times of the scans, and those of poses in the same unit, to seconds. Times of scans
/// are in ms, µs or ns where they lie within those of the poses only so, or where steps of more
/// than 10 s, as even as those of a lidar, become its period. A note names the unit.
void use_seconds(ScanPlacing& placing, bool poses_have_the_scans_times,
                 std::vector<std::string>& notes);

/// Scans whose names are more than a number take the rows that these numbers count, where there are
/// more rows than scans. A note says so.
void count_by_names(std::vector<ScanFile>& files, const ScanPlacing& placing,
                    std::vector<std::string>& notes);

}  // namespace underbrush::io
