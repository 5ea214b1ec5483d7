/// \file
/// Folders with one file for each scan, and their poses and times.
#pragma once
#include <vector>

#include "underbrush/io/open_log.hpp"
#include "underbrush/io/scan_names.hpp"
#include "underbrush/io/scan_placing.hpp"

namespace underbrush::io {

/// Joins the files with their poses and times into a source. Sets `scans`, `scan_infos`, `clock`,
/// `skipped` and `read_notes` of `input` and adds to its `notes`. An empty file of a folder is an
/// empty scan, and counted. The clock is fitted to the times of all scans (`fit_scan_clock`), also
/// those that are not selected; poses that have the scans' times get the clock's where their motion
/// shows that they follow it (`poses_follow_clock`). Where there are more rows of poses or times
/// than scans, scans take those that a number in their names counts. Times in ms, µs or ns become
/// s. Scans in gaps of the poses (`split_at_gaps`) are left out and counted. Throws `FormatError`
/// where a selected scan has no pose or no time.
void place_scans(std::vector<ScanFile> files, ScanPlacing placing, Input& input);

}  // namespace underbrush::io
