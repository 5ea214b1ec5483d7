#include "underbrush/fit/tile_fit.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/fit/gather.hpp"
#include "underbrush/fit/part_options.hpp"
#include "underbrush/ground/height_grid.hpp"

namespace underbrush::fit {
namespace {

cluster::VolumetricOptions volumetric_options(const FitOptions& options) {
  cluster::VolumetricOptions out = options.volumetric;
  out.ellipsoid.floor_m = out.top_down.noise_m = options.range_noise_m;
  // Points within the radius of the smallest ellipsoid would make copies of it.
  out.hierarchical.least_rms_m = std::sqrt(3) * least_extent_m(options);
  return out;
}

/// Which of a tile's points are ground, and what they add to the height map.
struct TileGround {
  std::vector<bool> is_ground;
  ground::SparseSums sums;
};

TileGround ground_of_tile(const TileStore& store, TileKey key, const Vec3& origin,
                          const FitOptions& options) {
  const TileStore::Loaded loaded = store.load(key, kTileMarginM);
  const std::vector<uint8_t> ground = ground::segment(loaded.point, options.segment);
  TileGround out;
  out.is_ground.assign(ground.begin(), ground.begin() + ptrdiff_t(loaded.core));
  std::vector<Vec3> points;
  for (size_t i = 0; i < loaded.core; ++i) {
    if (ground[i]) points.push_back(origin + loaded.point[i].cast<double>());
  }
  ground::HeightGrid grid(origin, options.ground);
  grid.add(points);
  out.sums = grid.sums();
  return out;
}

cluster::Volumes volumes_of_tile(const TileStore& store, TileKey key,
                                 const std::vector<bool>& is_ground, const FitOptions& options) {
  const TileStore::Loaded loaded = store.load(key, 0);
  std::vector<Vec3f> points, to_sensor;
  for (size_t i = 0; i < loaded.core; ++i) {
    if (is_ground[i]) continue;
    points.push_back(loaded.point[i]);
    to_sensor.push_back(loaded.to_sensor[i]);
  }
  const uint64_t seed =
      random_bits(options.seed, uint32_t(key.i) * 65537u + uint32_t(key.j), Purpose::kCluster);
  return cluster::volumes(options.fitter, {points, to_sensor}, volumetric_options(options), seed);
}

elements::TriangleMesh mesh_of_ground(const ground::HeightMap& heights, const FitOptions& options) {
  ground::GroundMesh ground = ground::triangulate(heights, options.triangulate);
  elements::TriangleMesh mesh;
  mesh.vertices = std::move(ground.vertices);
  mesh.triangles = std::move(ground.triangles);
  mesh.hit.resize(mesh.triangles.size());
  // Until residuals along the beam separate noise and roughness, all of the vertical residuals
  // counts as roughness.
  mesh.range_sigma_m = options.range_noise_m;
  mesh.roughness_m = heights.sigma_m;
  return mesh;
}

/// Tells ground from the rest in each tile. The record of a tile receives its part of the ground.
std::vector<std::vector<bool>> find_ground(const TileStore& store, const std::vector<TileKey>& anew,
                                           const FitOptions& options, const Vec3& origin,
                                           std::vector<TileRecord>& found, FitReport& report,
                                           const FitProgress& progress) {
  std::vector<std::vector<bool>> is_ground;
  size_t points = 0;
  for_tiles_in_order<TileGround>(
      anew, progress, "find ground",
      [&](size_t k) { return ground_of_tile(store, anew[k], origin, options); },
      [&](TileGround tile) {
        TileRecord record;
        record.key = anew[is_ground.size()];
        record.points = tile.is_ground.size();
        report.ground_points += tile.sums.n;
        points += record.points;
        record.ground = std::move(tile.sums);
        found.push_back(std::move(record));
        is_ground.push_back(std::move(tile.is_ground));
      });
  report.other_points = points - report.ground_points;
  return is_ground;
}

/// Where the ellipsoids of each tile of a record begin.
std::map<TileKey, uint32_t> first_ellipsoids(const FitRecord& record) {
  std::map<TileKey, uint32_t> first;
  uint32_t count = 0;
  for (const TileRecord& tile : record.tiles) {
    first[tile.key] = count;
    count += tile.ellipsoids;
  }
  return first;
}

/// The tiles of `before` with those of `anew` in their places, and for each whether it is one of
/// these.
std::vector<std::pair<TileRecord, bool>> joined(std::vector<TileRecord> before,
                                                std::vector<TileRecord> anew) {
  std::vector<std::pair<TileRecord, bool>> out;
  size_t k = 0;
  for (TileRecord& tile : anew) {
    for (; k < before.size() && before[k].key < tile.key; ++k) {
      out.emplace_back(std::move(before[k]), false);
    }
    if (k < before.size() && before[k].key == tile.key) ++k;
    out.emplace_back(std::move(tile), true);
  }
  for (; k < before.size(); ++k) out.emplace_back(std::move(before[k]), false);
  return out;
}

}  // namespace

TileOptions tile_options(const FitOptions& options) {
  TileOptions out = options.tiles;
  const cluster::Clustering* clustering = cluster::clustering_named(options.fitter);
  const double side = options.volumetric.voxel.side_m;
  if (clustering && clustering->in_voxels && side > 0) {
    out.tile_m = side * std::max(1.0, std::round(out.tile_m / side));
  }
  return out;
}

std::vector<uint32_t> fit_tiles(const TileStore& store, const std::vector<TileKey>& anew,
                                const FitOptions& options, FitResult& out,
                                const FitProgress& progress) {
  elements::Model& model = out.model;
  std::vector<TileRecord> found;
  const std::vector<std::vector<bool>> is_ground =
      find_ground(store, anew, options, model.origin, found, out.report, progress);
  const std::map<TileKey, uint32_t> first = first_ellipsoids(out.record);
  std::vector<std::pair<TileRecord, bool>> tiles =
      joined(std::move(out.record.tiles), std::move(found));
  ground::HeightGrid grid(model.origin, options.ground);
  for (const auto& [tile, is_new] : tiles) grid.merge(tile.ground);
  const auto fit_ground = [&] {
    if (grid.points() > 0) model.ground = mesh_of_ground(grid.solve(), options);
  };
  std::vector<cluster::Volumes> made(anew.size());
  const auto fit_volumes = [&] {
    if (!cluster::clustering_named(options.fitter)) return;
    size_t k = 0;
    for_tiles_in_order<cluster::Volumes>(
        anew, progress, "fit tiles",
        [&](size_t t) { return volumes_of_tile(store, anew[t], is_ground[t], options); },
        [&](cluster::Volumes tile) {
          out.report.unclustered_points += tile.unclustered_points;
          made[k++] = std::move(tile);
        });
  };
  parallel_invoke(fit_ground, fit_volumes);
  if (grid.points() == 0) {
    out.report.warnings.push_back("no ground was found: the model has no ground mesh");
  }
  std::vector<uint32_t> before;
  std::vector<elements::Ellipsoid> ellipsoids;
  out.record.tiles.clear();
  out.open.clear();
  size_t next = 0;
  const bool has_spacing = options.volumetric.spacing != cluster::BeamSpacing();
  for (auto& [tile, is_new] : tiles) {
    if (is_new) {
      const cluster::Volumes& of_tile = made[next++];
      tile.ellipsoids = uint32_t(of_tile.ellipsoids.size());
      ellipsoids.insert(ellipsoids.end(), of_tile.ellipsoids.begin(), of_tile.ellipsoids.end());
      out.open.insert(out.open.end(), of_tile.open.begin(), of_tile.open.end());
      before.resize(ellipsoids.size(), kNewEllipsoid);
    } else {
      for (uint32_t k = 0; k < tile.ellipsoids; ++k) {
        before.push_back(first.at(tile.key) + k);
        ellipsoids.push_back(model.ellipsoids[before.back()]);
      }
      if (has_spacing) out.open.resize(ellipsoids.size(), Eigen::Matrix3f::Zero());
    }
    out.record.tiles.push_back(std::move(tile));
  }
  model.ellipsoids = std::move(ellipsoids);
  return before;
}

bool is_free_space(const FitOptions& options, const elements::HitCount& hit,
                   const credit::TrialTimes& times) {
  const double beams = double(hit.hits) + hit.misses;
  return beams >= options.free_space_beams && hit.hits < options.free_space_below * beams &&
         times.are_brief();
}

void keep_ellipsoids(const std::vector<bool>& stays, FitResult& fitted) {
  std::vector<elements::Ellipsoid>& ellipsoids = fitted.model.ellipsoids;
  size_t k = 0, kept = 0;
  for (TileRecord& tile : fitted.record.tiles) {
    uint32_t left = 0;
    for (uint32_t n = 0; n < tile.ellipsoids; ++n, ++k) {
      if (!stays[k]) continue;
      if (!fitted.open.empty()) fitted.open[kept] = fitted.open[k];
      ellipsoids[kept++] = ellipsoids[k];
      ++left;
    }
    tile.ellipsoids = left;
  }
  ellipsoids.resize(kept);
  if (!fitted.open.empty()) fitted.open.resize(kept);
}

}  // namespace underbrush::fit
