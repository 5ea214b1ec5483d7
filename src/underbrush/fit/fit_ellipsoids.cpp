#include <algorithm>
#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/fit/gather.hpp"
#include "underbrush/fit/make_model.hpp"

namespace underbrush::fit {
namespace {

VolumetricOptions volumetric_options(const FitOptions& options) {
  VolumetricOptions out = options.volumetric;
  out.ellipsoid.floor_m = out.top_down.noise_m = options.range_noise_m;
  out.top_down.tau = options.tau;
  return out;
}

/// Rounds the side of the tiles to whole voxels, so that no border cuts a voxel.
TileOptions tile_options(const FitOptions& options, const Clustering* clustering) {
  TileOptions out = options.tiles;
  const double side = options.volumetric.voxel.side_m;
  if (clustering && clustering->in_voxels && side > 0) {
    out.tile_m = side * std::max(1.0, std::round(out.tile_m / side));
  }
  return out;
}

/// Which of a tile's points are ground, and where the ground points lie in the world, m.
struct TileGround {
  std::vector<bool> is_ground;
  std::vector<Vec3> points;
};

TileGround ground_of_tile(const TileStore& store, TileKey key, const Vec3& origin,
                          const FitOptions& options) {
  const TileStore::Loaded loaded = store.load(key, kTileMarginM);
  const std::vector<uint8_t> ground = ground::segment(loaded.point, options.segment);
  TileGround out;
  out.is_ground.assign(ground.begin(), ground.begin() + ptrdiff_t(loaded.core));
  for (size_t i = 0; i < loaded.core; ++i) {
    if (ground[i]) out.points.push_back(origin + loaded.point[i].cast<double>());
  }
  return out;
}

Volumes volumes_of_tile(const TileStore& store, TileKey key, const std::vector<bool>& is_ground,
                        const FitOptions& options) {
  const TileStore::Loaded loaded = store.load(key, 0);
  std::vector<Vec3f> points, to_sensor;
  for (size_t i = 0; i < loaded.core; ++i) {
    if (is_ground[i]) continue;
    points.push_back(loaded.point[i]);
    to_sensor.push_back(loaded.to_sensor[i]);
  }
  const uint64_t seed =
      random_bits(options.seed, uint32_t(key.i) * 65537u + uint32_t(key.j), Purpose::kCluster);
  return volumes(options.fitter, {points, to_sensor}, volumetric_options(options), seed);
}

elements::TriangleMesh mesh_of_ground(const ground::HeightMap& heights, const FitOptions& options) {
  ground::GroundMesh ground = ground::triangulate(heights, options.triangulate);
  elements::TriangleMesh mesh;
  mesh.vertices = std::move(ground.vertices);
  mesh.triangles = std::move(ground.triangles);
  mesh.hit.resize(mesh.triangles.size());
  // Until residuals along the beam tell them apart: all of the vertical ones is roughness.
  mesh.range_sigma_m = options.range_noise_m;
  mesh.roughness_m = heights.sigma_m;
  return mesh;
}

/// Tells ground from the rest in each tile, and adds the ground points to the height map.
std::vector<std::vector<bool>> find_ground(const TileStore& store, const FitOptions& options,
                                           const Vec3& origin, ground::HeightGrid& grid,
                                           FitReport& report, const FitProgress& progress) {
  const std::vector<TileKey> tiles = store.tiles();
  std::vector<std::vector<bool>> is_ground;
  for_tiles_in_order<TileGround>(
      tiles, progress, "find ground",
      [&](size_t k) { return ground_of_tile(store, tiles[k], origin, options); },
      [&](TileGround tile) {
        grid.add(tile.points);
        report.ground_points += tile.points.size();
        is_ground.push_back(std::move(tile.is_ground));
      });
  report.other_points = store.size() - store.thinned() - report.ground_points;
  return is_ground;
}

void fit_elements(const TileStore& store, const FitOptions& options, bool with_ellipsoids,
                  FitResult& out, const FitProgress& progress) {
  elements::Model& model = out.model;
  const std::vector<TileKey> tiles = store.tiles();
  ground::HeightGrid grid(model.origin, options.ground);
  const std::vector<std::vector<bool>> is_ground =
      find_ground(store, options, model.origin, grid, out.report, progress);
  const auto fit_ground = [&] {
    if (grid.points() > 0) model.ground = mesh_of_ground(grid.solve(), options);
  };
  const auto fit_volumes = [&] {
    if (!with_ellipsoids) return;
    for_tiles_in_order<Volumes>(
        tiles, progress, "fit tiles",
        [&](size_t k) { return volumes_of_tile(store, tiles[k], is_ground[k], options); },
        [&](const Volumes& tile) {
          model.ellipsoids.insert(model.ellipsoids.end(), tile.ellipsoids.begin(),
                                  tile.ellipsoids.end());
          out.report.unclustered_points += tile.unclustered_points;
        });
  };
  parallel_invoke(fit_ground, fit_volumes);
  if (grid.points() == 0) {
    out.report.warnings.push_back("no ground was found: the model has no ground mesh");
  }
}

void drop_free_space(const FitOptions& options, elements::Model& model, FitReport& report) {
  report.free_space_ellipsoids = std::erase_if(model.ellipsoids, [&](const elements::Ellipsoid& e) {
    const double beams = double(e.hit.hits) + e.hit.misses;
    return beams >= options.free_space_beams && e.hit.hits < options.free_space_below * beams;
  });
}

}  // namespace

FitResult fit_ellipsoids(BeamSource& source, const FitOptions& options,
                         const FitProgress& progress) {
  const Clustering* clustering = clustering_named(options.fitter);
  TileStore store(tile_options(options, clustering));
  FitResult out;
  gather(source, options, store, out, progress);
  if (clustering && clustering->in_voxels && options.volumetric.voxel.bounded) {
    out.model.voxel_m = options.volumetric.voxel.side_m;
  }
  fit_elements(store, options, clustering != nullptr, out, progress);
  const CreditedResiduals residuals =
      count_hits(out.model, source, options.credit, stage_of(progress, "count hits"));
  set_noise(out.model.ground, residuals.ground, options.range_noise_m);
  drop_free_space(options, out.model, out.report);
  return out;
}

}  // namespace underbrush::fit
