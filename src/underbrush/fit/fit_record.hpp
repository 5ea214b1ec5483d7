/// \file
/// The record of the tiles of a fit, which `update` needs to add scans without fitting all of them
/// again.
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/core/range_cut.hpp"
#include "underbrush/core/tile_store.hpp"
#include "underbrush/ground/sparse_sums.hpp"

namespace underbrush::fit {

/// A tile of a model.
struct TileRecord {
  TileKey key;
  uint64_t points = 0;  ///< Returns that the tile was fitted to.
  uint64_t later = 0;   ///< Returns that updates have met in it since, without fitting it anew.
  uint64_t unexplained = 0;  ///< Returns of `later` that no element explains.
  uint32_t ellipsoids = 0;  ///< The model holds the ellipsoids of its tiles one tile after another.
  ground::SparseSums ground;  ///< The tile's part of the ground's normal equations.
};

/// The tiles of a model in ascending order of keys; without tiles where the fitter has none.
struct FitRecord {
  double tile_m = 0;  ///< m; side of the tiles.
  std::vector<TileRecord> tiles;
  /// The residuals of all returns on the ground (`MeshResiduals::counts`), or none.
  std::vector<uint32_t> residuals;
  LastReturns last_returns;  ///< The returns of all logs near their largest range.

  /// Returns the tile, or nullptr.
  const TileRecord* find(TileKey key) const;
  /// The number of ellipsoids of all tiles.
  size_t ellipsoids() const;
};

}  // namespace underbrush::fit
