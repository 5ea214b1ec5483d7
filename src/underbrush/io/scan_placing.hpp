/// \file
/// What places the scans of a folder in the world.
#pragma once
#include <string>
#include <vector>

#include "underbrush/io/open_log.hpp"
#include "underbrush/io/poses.hpp"
#include "underbrush/io/table.hpp"

namespace underbrush::io {

/// Poses and times of the scans of a folder.
struct ScanPlacing {
  PoseList poses;                    ///< By frame number where they have no times.
  std::string poses_name;            ///< File of the poses, for error messages.
  std::vector<double> times;         ///< s, by frame number; empty if unknown.
  std::string times_name;            ///< File of the times, for error messages.
  bool points_in_world = false;      ///< The points are in the world frame, else in the sensor's.
  FrameRange frames;                 ///< Scans to read, by number.
  bool fit_clock = false;            ///< Whether rounded times of scans get a steady clock.
  std::vector<std::string> columns;  ///< Names of the columns of files that have none.
  double unit_m = 1;                 ///< Unit of the points' coordinates, m.
  double period_s = 0;               ///< Time between scans, s, if there are no times.
  TimesCount count = TimesCount::kAfter;  ///< How times of points count.
};

}  // namespace underbrush::io
