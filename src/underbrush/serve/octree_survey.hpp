/// \file
/// The first pass over a log whose octree is built: its contents and the places of its points.
#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "underbrush/serve/octree_point.hpp"

namespace underbrush::serve {

/// Numbers of points in the cells of a grid without bounds. Once there are too many cells their
/// side doubles, so that memory is bounded.
class CellCounts {
 public:
  /// The cells' side begins with 2^bits units, a quarter of a metre.
  explicit CellCounts(size_t most_cells = size_t(1) << 21, uint32_t bits = 18);
  void add(const std::array<int64_t, 3>& at);
  /// log₂ of the cells' side in units.
  uint32_t bits() const { return bits_; }
  /// A cell and the number of its points.
  struct Cell {
    std::array<int64_t, 3> at{};  ///< Coordinates in units divided by the cells' side.
    uint64_t points = 0;          ///< 0 where the place is free.
  };
  /// Returns the cells that have points.
  std::vector<Cell> cells() const;

 private:
  Cell& place(const std::array<int64_t, 3>& at);
  void grow();

  size_t most_, used_ = 0, latest_ = 0;
  uint32_t bits_;
  std::vector<Cell> table_;
};

/// The result of the first pass.
struct OctreeSurvey {
  Vec3 origin = Vec3::Zero();  ///< m, world; a whole number of metres near the first beam.
  size_t rows = 0, beams = 0, points = 0;
  std::array<int64_t, 3> low{}, high{};  ///< Bounds of the points in units.
  double first_s = std::numeric_limits<double>::infinity(), last_s = -first_s;
  float least_intensity = 0, most_intensity = 0;
  uint16_t most_ring = 0;
  uint8_t most_echo = 0;
  std::vector<uint64_t> labels = std::vector<uint64_t>(65536);  ///< Number of points by class.
  bool has_labels = false;
  CellCounts counts;
  std::vector<OctreeRun> runs;

  /// The least cube of cells of `counts`, at least two along each side, that holds all points.
  OctreeRoot root() const;
};

/// Calls `use` for each return of a chunk. `first_row` is the row at which the chunk begins, and
/// `survey` gives origin and time.
void for_each_return(const BeamLog& chunk, size_t first_row, const OctreeSurvey& survey,
                     const std::function<void(const OctreePoint&)>& use);

/// Reads a log once. Throws as `build_octree` does.
OctreeSurvey survey_log(BeamSource& log, const std::function<void(size_t)>& progress);

}  // namespace underbrush::serve
