/// \file
/// Labels for every hit of a log: ground, or the object that it belongs to.
#pragma once
#include <functional>
#include <string_view>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/ground/ground_flags.hpp"
#include "underbrush/ground/height_grid.hpp"
#include "underbrush/primitives/objects.hpp"

namespace underbrush::primitives {

/// The kind of a hit, if it is known before the search for objects.
enum class Prior : uint8_t { kObject, kGround, kOther };

/// Options of `segment_log`.
struct SegmentLogOptions {
  ground::SegmentOptions ground;
  double tile_m = 32;  ///< m; side of the tiles of the ground segmentation.
  ground::HeightGridOptions height;
  ObjectOptions objects;
  double min_range_m = 0;  ///< m; nearer hits are ignored, such as those on the vehicle that
                           ///< carries the sensor.
};

/// Labels with one entry for each hit, in the log's order.
struct LogLabels {
  std::vector<uint8_t> ground;   ///< 1 = ground.
  std::vector<uint32_t> object;  ///< Number of the object, 0 for none.
  std::vector<FoundObject> objects;
  ground::HeightMap height;  ///< The surface of the ground.
  double cell_m = 0;         ///< m; side of the columns of `ObjectFinder`.
  size_t near = 0;           ///< Hits nearer than `min_range_m`.
  size_t off_ground = 0;     ///< Hits with no ground within 30 m; they are in no object.
};

/// A function for the progress of `segment_log`, called with (stage, done, total).
using SegmentProgress = std::function<void(std::string_view, size_t, size_t)>;

/// Labels the hits of a log. If `prior` is not empty, it has the kind of each hit, and the function
/// only searches for objects; else it segments the ground first. Reads the log up to four times and
/// uses a few bytes of memory for each hit. Throws as `ground::segment` does, and
/// `std::invalid_argument` where `prior` has another length.
LogLabels segment_log(BeamSource& source, const SegmentLogOptions& options,
                      const std::vector<Prior>& prior = {}, const SegmentProgress& progress = {});

}  // namespace underbrush::primitives
