#include <algorithm>

#include "underbrush/fit/gather.hpp"
#include "underbrush/fit/make_model.hpp"
#include "underbrush/fit/tile_fit.hpp"

namespace underbrush::fit {

FitResult fit_ellipsoids(BeamSource& source, const FitOptions& options,
                         const FitProgress& progress) {
  const cluster::Clustering* clustering = cluster::clustering_named(options.fitter);
  const TileOptions tiles = tile_options(options);
  TileStore store(tiles);
  FitResult out;
  gather(source, options, store, out, progress);
  if (clustering && clustering->in_voxels && options.volumetric.voxel.bounded) {
    out.model.voxel_m = options.volumetric.voxel.side_m;
  }
  out.record.tile_m = tiles.tile_m;
  fit_tiles(store, store.tiles(), options, out, progress);
  const credit::Tally tally =
      credit::count_hits(out.model, source, options.credit, stage_of(progress, "count hits"));
  credit::set_noise(out.model.ground, tally.residuals.ground, options.range_noise_m);
  out.record.residuals = tally.residuals.ground.counts();
  std::vector<bool> stays;
  for (size_t k = 0; k < tally.times.size(); ++k) {
    stays.push_back(!is_free_space(options, out.model.ellipsoids[k].hit, tally.times[k]));
  }
  keep_ellipsoids(stays, out);
  out.report.free_space_ellipsoids = size_t(std::count(stays.begin(), stays.end(), false));
  return out;
}

}  // namespace underbrush::fit
