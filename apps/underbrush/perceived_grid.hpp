/// \file
/// The occupancy grid of a log's cycles.
#pragma once
#include <memory>
#include <optional>
#include <string>

#include "stages.hpp"
#include "underbrush/perception/grid_file.hpp"
#include "verbs.hpp"

namespace underbrush::app {

/// What a grid is made with.
struct GridSetup {
  std::string output;  ///< A picture (.png) or JSON; "" = no grid.
  perception::GridOptions grid;
  perception::FreeAreaOptions area;
};

/// Adds the options of the grid as a group.
void add_grid_options(Verb& verb, GridSetup& setup);

/// The grid of a log, and its file.
class PerceivedGrid {
 public:
  /// Throws `std::invalid_argument` for options out of range and `IoError`.
  PerceivedGrid(const GridSetup& setup, const std::string& provenance);
  /// Enters the beams of a cycle.
  void step(const perception::MergedCloud& cloud);
  /// Writes what is left to write. Throws `IoError`.
  void close();
  /// The area of each kind of cells at the end, m², and the time of a cycle.
  Json summary() const;
  std::string text() const;

 private:
  GridSetup setup_;
  perception::OccupancyGrid grid_;
  std::optional<perception::GridWriter> writer_;
  size_t cycles_ = 0;
  double seconds_ = 0;
};

}  // namespace underbrush::app
