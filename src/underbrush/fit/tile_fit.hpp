/// \file
/// The part of a fit that makes elements tile by tile, which `fit` and `update` share.
#pragma once
#include <limits>
#include <vector>

#include "underbrush/core/tile_store.hpp"
#include "underbrush/fit/fit_options.hpp"
#include "underbrush/fit/fit_result.hpp"

namespace underbrush::fit {

/// The tiles of a fit: those of the options, with sides of whole voxels for `voxel`, so that no
/// border cuts a voxel.
TileOptions tile_options(const FitOptions& options);

/// The number of a new ellipsoid in the list of `fit_tiles`.
inline constexpr uint32_t kNewEllipsoid = std::numeric_limits<uint32_t>::max();

/// Fits the tiles `anew` (ascending, all in `store`) and makes the ground mesh of all tiles.
///
/// The tiles of the record of `out` that are not in `anew` keep their ellipsoids, bit for bit,
/// and their part of the ground's equations. The tiles in `anew` are replaced or added by the
/// points of the store: the ground is segmented with the points within `kTileMarginM`, and the
/// other points are clustered by `options.fitter`. Ellipsoids come in the order of the tiles. The
/// counts of the ground mesh are empty. Returns for each ellipsoid its number before, or
/// `kNewEllipsoid`.
std::vector<uint32_t> fit_tiles(const TileStore& store, const std::vector<TileKey>& anew,
                                const FitOptions& options, FitResult& out,
                                const FitProgress& progress);

/// Whether an ellipsoid is free space by its trials and their times
/// (`FitOptions::free_space_below`).
bool is_free_space(const FitOptions& options, const elements::HitCount& hit,
                   const credit::TrialTimes& times);

/// Keeps only the ellipsoids that stay, in the model and in its record.
void keep_ellipsoids(const std::vector<bool>& stays, FitResult& fitted);

}  // namespace underbrush::fit
