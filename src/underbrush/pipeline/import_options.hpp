/// \file
/// The options of the verb `import`, and their table.
#pragma once
#include <cmath>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "underbrush/core/option.hpp"

namespace underbrush::pipeline {

/// The options of `import`. Their words are those of the command line; a text is empty where it is
/// not given.
struct ImportOptions {
  std::string format;                ///< One of `io::input_formats()`; "" = detected.
  std::string poses, times, labels;  ///< Files.
  std::string label_set, keep, frames;
  std::string columns;                ///< Names of a file's columns, divided by commas.
  std::string unit = "m";             ///< Unit of the coordinates: m, cm, mm or ft.
  std::string point_times = "after";  ///< How times of points count: after, before or until.
  std::string assets;                 ///< Folder, for surveys of HELIOS++.
  std::string deskew, infer_misses;   ///< Sensors: names of the catalogue, or files.
  bool times_as_given = false, points_in_world = false, float_coordinates = false;
  double unknown_below_deg = NAN, elevation_offset_deg = 0, max_range_m = 0;

  /// The files that these options name.
  std::vector<std::filesystem::path> files() const;
};

/// The options of `import`.
std::span<const Option<ImportOptions>> import_options();

}  // namespace underbrush::pipeline
