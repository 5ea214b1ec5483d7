#include <cmath>

#include "underbrush/fit/gather.hpp"
#include "underbrush/fit/make_model.hpp"

namespace underbrush::fit {
namespace {

/// Drops surface triangles that more beams passed than ended at. The others stay opaque.
void carve(BeamSource& source, const FitOptions& options, elements::Model& model, FitReport& report,
           const FitProgress& progress) {
  credit::count_hits(model, source, options.credit, stage_of(progress, "carve"));
  elements::TriangleMesh& mesh = model.surface;
  size_t kept = 0;
  for (size_t t = 0; t < mesh.size(); ++t) {
    if (mesh.hit[t].misses <= mesh.hit[t].hits) mesh.triangles[kept++] = mesh.triangles[t];
  }
  report.carved_triangles = mesh.size() - kept;
  mesh.triangles.resize(kept);
  mesh.hit.assign(kept, {});
}

void fit_mesh(const TileStore& store, const FitOptions& options,
              const surface::SignedDistance& distance, elements::Model& model, FitReport& report,
              const FitProgress& progress) {
  const std::vector<TileKey> tiles = store.tiles();
  const double margin = surface::surface_margin_m(options.surface);
  double squares = 0;
  size_t points = 0;
  for_tiles_in_order<surface::SurfaceTile>(
      tiles, progress, "fit tiles",
      [&](size_t k) {
        const TileStore::Loaded loaded = store.load(tiles[k], margin);
        const Eigen::Vector2d lo = store.corner(tiles[k]);
        const double side = options.tiles.tile_m;
        return surface::surface_tile(loaded.point, loaded.to_sensor,
                                     {lo.x(), lo.y(), lo.x() + side, lo.y() + side},
                                     options.surface, distance);
      },
      [&](surface::SurfaceTile tile) {
        elements::TriangleMesh& mesh = model.surface;
        const uint32_t first = uint32_t(mesh.vertices.size());
        mesh.vertices.insert(mesh.vertices.end(), tile.mesh.vertices.begin(),
                             tile.mesh.vertices.end());
        for (const auto& t : tile.mesh.triangles) {
          mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
        }
        squares += tile.sum_squares_m2;
        points += tile.points;
      });
  model.surface.hit.resize(model.surface.size());
  model.surface.range_sigma_m = options.range_noise_m;
  model.surface.roughness_m = points ? std::sqrt(squares / double(points)) : 0;
  report.other_points = store.size();
}

void fit_noise(BeamSource& source, const FitOptions& options, elements::Model& model,
               const FitProgress& progress) {
  elements::TriangleMesh& mesh = model.surface;
  if (options.surface.noise_m > 0) {
    mesh.range_sigma_m = options.surface.noise_m;
    mesh.roughness_m = 0;
    return;
  }
  const credit::CreditedResiduals residuals =
      credit::count_hits(model, source, options.credit, stage_of(progress, "fit noise")).residuals;
  credit::set_noise(mesh, residuals.surface, options.range_noise_m);
  mesh.hit.assign(mesh.size(), {});  // opaque
}

}  // namespace

FitResult fit_surface(BeamSource& source, const FitOptions& options,
                      const surface::SignedDistance& distance, const FitProgress& progress) {
  TileStore store(options.tiles);
  FitResult out;
  gather(source, options, store, out, progress);
  fit_mesh(store, options, distance, out.model, out.report, progress);
  if (options.surface.carve) carve(source, options, out.model, out.report, progress);
  fit_noise(source, options, out.model, progress);
  return out;
}

}  // namespace underbrush::fit
