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

/// What is known of a hit before objects are looked for.
enum class Prior : uint8_t { kObject, kGround, kOther };

/// Options of `segment_log`.
struct SegmentLogOptions {
  ground::SegmentOptions ground;
  double tile_m = 32;  ///< Of the ground segmentation.
  ground::HeightGridOptions height;
  ObjectOptions objects;
  double min_range_m = 0;  ///< Nearer hits are nothing: the vehicle that carries the sensor.
};

/// One entry a hit, in the log's order.
struct LogLabels {
  std::vector<uint8_t> ground;   ///< 1 = ground.
  std::vector<uint32_t> object;  ///< Number of the object, 0 for none.
  std::vector<FoundObject> objects;
  ground::HeightMap height;  ///< The ground's surface.
  double cell_m = 0;         ///< Of `ObjectFinder`.
  size_t near = 0;           ///< Hits nearer than `min_range_m`.
  size_t off_ground = 0;     ///< Hits with no ground within 30 m: in no object.
};

/// Called as the work goes on: stage, done, total.
using SegmentProgress = std::function<void(std::string_view, size_t, size_t)>;

/// Labels the hits. Where `prior` is not empty it says of each hit what it is, and only objects are
/// looked for; else ground is told from the rest first. Reads the log up to four times; memory is a
/// few bytes a hit. Throws as `ground::segment` does, and where `prior` has another length.
LogLabels segment_log(BeamSource& source, const SegmentLogOptions& options,
                      const std::vector<Prior>& prior = {}, const SegmentProgress& progress = {});

}  // namespace underbrush::primitives
