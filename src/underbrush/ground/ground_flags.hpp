/// \file
/// Ground segmentation of a whole log, tile by tile.
#pragma once
#include <functional>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/ground/segment.hpp"

namespace underbrush::ground {

/// Returns one flag for each hit, in the log's order: 1 = ground. Each tile of side `tile_m` is
/// segmented with the points up to `kTileMarginM` around it, as `fit` does. Reads the log twice
/// from its beginning and keeps one byte for each hit; points that do not fit into memory go to
/// disk. `progress(done, total)` may be empty. Throws as `ground::segment` does.
std::vector<uint8_t> ground_flags(BeamSource& source, const ground::SegmentOptions& options,
                                  double tile_m = 32,
                                  const std::function<void(size_t, size_t)>& progress = {});

}  // namespace underbrush::ground
