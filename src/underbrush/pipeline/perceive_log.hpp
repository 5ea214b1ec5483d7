/// \file
/// The verb `perceive`: a log in, lists of tracked objects out, and a map of the free area.
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "underbrush/perception/perceive_options.hpp"

namespace underbrush::pipeline {

/// The file for the occupancy grids of a log: a picture (.png) of the last cycle, else JSON of all
/// cycles.
struct GridFile {
  std::filesystem::path path;
  std::string provenance;  ///< JSON.
};

/// The occupancy grid at the end of a log.
struct GridSummary {
  size_t cycles = 0;
  std::array<double, 4> area_m2{};  ///< The area of each `perception::CellLabel`.
  double seconds = 0;               ///< s; the sum over all cycles.
};

/// The lists of a log, and its occupancy grid.
struct Perceived {
  perception::PerceivedLog log;
  std::optional<GridSummary> grid;
};

/// Turns a log into lists of objects, and into occupancy grids where `grid` names a file for them.
/// `truth` may be null for the real pipeline. Throws `std::invalid_argument` for options out of
/// range, `DataError` and `IoError`.
Perceived perceive_log(BeamSource& log, const perception::LogTruth* truth,
                       const perception::PerceiveOptions& options, const GridFile* grid = nullptr);

}  // namespace underbrush::pipeline
