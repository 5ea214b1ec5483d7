/// \file
/// This file has the first pass of every fit, which sorts the points of a log into tiles.
#pragma once
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "underbrush/core/parallel.hpp"
#include "underbrush/core/tile_store.hpp"
#include "underbrush/fit/fit_options.hpp"
#include "underbrush/fit/fit_result.hpp"

namespace underbrush::fit {

/// Reads the log once. It fills `store` with the points of all returns, relative to the model's
/// origin, and begins the model (fitter, τ, origin, maximum range) and the report (counts,
/// warnings) of `out`. Throws `std::invalid_argument` for an empty log and for a log without
/// returns.
void gather(BeamSource& source, const FitOptions& options, TileStore& store, FitResult& out,
            const FitProgress& progress);

/// The tile in which a point (m) lies, for tiles of the side `tile_m` (m).
TileKey tile_of(const Vec3f& point, double tile_m);

/// A set of tiles.
class TileSet {
 public:
  TileSet(const std::vector<TileKey>& tiles, double tile_m);
  /// Whether a point lies in one of the tiles or within `kTileMarginM` of it (the corners of that
  /// margin included).
  bool is_near(const Vec3f& point) const;

 private:
  double tile_m_;
  std::set<TileKey> tiles_;
};

/// Reads a log once and adds the points of its returns, relative to `origin` (m, world), to
/// `store`; with `wanted` only those near these tiles. Nearer returns than `min_range_m` and those
/// of movers are left out and counted in `report`. Returns all their ranges.
RangeCut add_returns(BeamSource& source, const Vec3& origin, double min_range_m,
                     const TileSet* wanted, TileStore& store, FitReport& report,
                     const FitProgress& progress);

/// Runs `work(k)` for every tile number k on all threads, and `merge(result)` on the results in the
/// order of the tiles. Only a few results are held in memory at a time.
template <class Result, class Work, class Merge>
void for_tiles_in_order(const std::vector<TileKey>& tiles, const FitProgress& progress,
                        std::string_view stage, Work work, Merge merge) {
  std::vector<Result> results(tiles.size());
  parallel_in_order(
      tiles.size(), 8 * size_t(threads()), [&](size_t k) { results[k] = work(k); },
      [&](size_t k) {
        merge(std::exchange(results[k], {}));
        if (progress) progress(stage, k + 1, tiles.size());
      });
}

/// Binds a stage name to `progress`, which gives the callback (done, total) that other modules
/// take.
inline std::function<void(size_t, size_t)> stage_of(const FitProgress& progress,
                                                    std::string_view stage) {
  return [&progress, stage](size_t done, size_t total) {
    if (progress) progress(stage, done, total);
  };
}

}  // namespace underbrush::fit
