/// \file
/// The options of the verb `perceive`, and their table.
#pragma once
#include <span>
#include <string>

#include "underbrush/core/option.hpp"
#include "underbrush/perception/free_area.hpp"
#include "underbrush/perception/perceive.hpp"

namespace underbrush::perception {

/// The help of the options that turn labelled boxes, "truth-elevation-deg" and the like.
inline constexpr const char* kElevationHelp =
    "Turn labelled boxes up by this angle, if import turned the beams by it";

/// The options of `perceive`. Their words are those of the command line; a text is empty where it
/// is not given.
struct PerceiveOptions {
  /// File of the true objects, and the elevation by which labelled boxes in it are turned.
  std::string truth;
  double truth_elevation_deg = 0;
  std::string pipeline = "model";  ///< "model", which assigns points by the truth, or "real".
  std::string rig;                 ///< File of the vehicle's sensors.
  std::string existence = "probability", reference = "corner", heading = "points", ground = "cone";
  double latency_ms = 0;
  bool as_measured = false, no_deskew = false;
  /// The options that are not words above. `real.track` is that of `model.track`.
  PerceptionSetup setup;
  GridOptions grid;
  FreeAreaOptions area;
};

/// The options of `perceive`.
std::span<const Option<PerceiveOptions>> perceive_options();

/// Returns the setup that the options describe. Reads the file of the rig. Throws `FormatError` and
/// `std::invalid_argument`.
PerceptionSetup setup_of(const PerceiveOptions& options);

}  // namespace underbrush::perception
