/// \file
/// Range images of a scan: the measured ranges of its beams, and their ranges in a world or in
/// another log.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "underbrush/serve/log_data.hpp"
#include "underbrush/serve/world_data.hpp"

namespace underbrush::serve {

/// The pixel of each beam in a range image. Rings are rows, the highest above. Where they all have
/// about as many beams, columns are beams in order of time; else columns are equal steps of
/// azimuth. A scan of fewer than four rings is an image of azimuth and elevation. The azimuth falls
/// to the right, as one sees it from the sensor.
struct ImageLayout {
  uint32_t width = 0, height = 0;
  std::vector<uint32_t> pixel;  ///< One for each beam: row × width + column.
};
/// Lays out the beams of a scan; at most 4 194 304 pixels.
ImageLayout image_layout(const BeamLog& beams);

/// Returns the ranges that `underbrush simulate WORLD --like LOG` gives the beams with this seed
/// and otherwise default options. `keyframes` is that of `LogData::keyframes_serve` for the world.
std::vector<float> simulated_ranges(const LoggedBeams& beams, const WorldData& world, uint64_t seed,
                                    bool keyframes);
/// Returns the ranges of the same beams in another log. Throws `DataError` where it does not have
/// them: equal numbers, and directions that differ by less than 0.01 rad.
std::vector<float> other_ranges(const LoggedBeams& beams, LogData& other);

/// Returns an image as bytes: width, height, and 1 if there are other ranges than the measured ones
/// or 0 (uint32 each), then 12 bytes for each pixel, row by row: the row of the log (uint32), the
/// measured range and the other one (float32, m; 0 for a miss). A pixel without a beam has the row
/// 2³² − 1. Of several beams in a pixel the first one counts. `other` is empty, or has one range
/// for each beam.
std::string range_image(const LoggedBeams& beams, const std::vector<float>& other);

}  // namespace underbrush::serve
