/// \file
/// The returns of new scans, counted by the tiles of a model.
#pragma once
#include <map>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/range_cut.hpp"
#include "underbrush/fit/fit.hpp"

namespace underbrush::update {

/// The new returns of one tile.
struct TileReturns {
  size_t returns = 0;       ///< New returns in the tile.
  size_t unexplained = 0;   ///< New returns that no element of the model explains.
  bool is_touched = false;  ///< Whether new returns lie in the tile or within `kTileMarginM` of it.
};

/// The counts of new scans, and the tiles that their returns touch.
struct NewReturns {
  size_t beams = 0, hits = 0, near = 0, movers = 0, unexplained = 0;
  RangeCut ranges;
  std::map<TileKey, TileReturns> tiles;
};

/// Reads new scans once and compares their returns with a model and its tiles. A tile without a
/// return of its own is among the result only if the model has it. Throws `DataError` for scans
/// that lie farther from every tile than the sensor reaches.
NewReturns new_returns(BeamSource& added, const elements::Model& model,
                       const fit::FitRecord& record, const fit::FitOptions& options,
                       const fit::FitProgress& progress);

}  // namespace underbrush::update
