/// \file
/// Ground of a whole log, tile by tile.
#pragma once
#include <functional>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/ground/segment.hpp"

namespace underbrush::ground {

/// One flag a hit, in the log's order: 1 = ground. Tiles of `tile_m` see the points within 10 m
/// around them, as in `fit`. Reads the log twice from its beginning and keeps a byte a hit; points
/// that do not fit into memory go to disk. `progress(done, total)` may be empty. Throws as
/// `ground::segment` does.
std::vector<uint8_t> ground_flags(BeamSource& source, const ground::SegmentOptions& options,
                                  double tile_m = 32,
                                  const std::function<void(size_t, size_t)>& progress = {});

}  // namespace underbrush::ground
