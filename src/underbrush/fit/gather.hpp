/// \file
/// The first pass of every fit: the points of a log by tile.
#pragma once
#include <string_view>
#include <utility>
#include <vector>

#include "underbrush/core/parallel.hpp"
#include "underbrush/core/tile_store.hpp"
#include "underbrush/fit/fit.hpp"

namespace underbrush::fit {

/// Reads the log once: fills `store` with the points of its hits relative to the model's origin,
/// and begins the model (fitter, τ, origin, maximum range) and the report (counts, warnings).
/// Throws `std::invalid_argument` for options out of range and for a log without any return.
void gather(BeamSource& source, const FitOptions& options, TileStore& store, FitResult& out,
            const FitProgress& progress);

/// Runs `work` for the numbers of all tiles on all threads and `merge` for what it gives, in order,
/// holding only a few results at a time.
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

/// The progress of one stage as the functions of the library take it.
inline std::function<void(size_t, size_t)> stage_of(const FitProgress& progress,
                                                    std::string_view stage) {
  return [&progress, stage](size_t done, size_t total) {
    if (progress) progress(stage, done, total);
  };
}

}  // namespace underbrush::fit
