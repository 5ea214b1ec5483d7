/// \file
/// This file writes occupancy grids, as JSON or as a picture (docs/reference/object-lists.md).
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/core/file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/image.hpp"
#include "underbrush/perception/free_area.hpp"

namespace underbrush::perception {

/// The label of a cell.
enum class CellLabel : uint8_t { kUnknown, kFree, kPermeable, kSolid };

/// The label of each cell, row by row from the least y on: its most probable state if it is at
/// least as probable as `probability`, else unknown.
std::vector<CellLabel> cell_labels(const OccupancyGrid& grid, double probability);

/// The grid from above, a pixel for each cell, the world's y axis upwards: free cells are white,
/// permeable ones green, solid ones black and unknown ones grey.
io::Image picture_of_grid(const OccupancyGrid& grid, double probability);

/// Writes the grids of a log cycle by cycle to a JSON file, which appears as a whole with `close`.
class GridWriter {
 public:
  /// `provenance` is JSON, or empty. Throws `IoError`.
  GridWriter(const std::filesystem::path& path, const std::string& provenance,
             const FreeAreaOptions& area);
  /// Adds a cycle: the labels of its cells in runs, and the outline of the free area.
  void write(const OccupancyGrid& grid, const Pose& world_from_vehicle, double time_s);
  /// Throws `IoError`.
  void close();

 private:
  FreeAreaOptions area_;
  io::AtomicFile file_;
  OutputFile out_;
  bool is_first_ = true;
  std::vector<Vec3> outline_;
};

}  // namespace underbrush::perception
