/// \file
/// A sample of a log that a viewer shows while the log's octree is being built.
#pragma once
#include <filesystem>
#include <string>

namespace underbrush::serve {

/// Returns returns of a log as bytes: their number and 0 (uint32), the world coordinates of the
/// origin of the log's octree (3 × float64, m), and then the columns of a node of an octree
/// (docs/reference/octree.md), places relative to the origin and times to the earliest row that was
/// read. Rows are read in pieces at equal steps of the file, 131 072 rows at most, so that it takes
/// the same time for any length of the log. Pieces with a row that is left out elsewhere are left
/// out. Throws `std::invalid_argument` for a log whose rows have no fixed places in its file.
std::string log_preview(const std::filesystem::path& log);

}  // namespace underbrush::serve
