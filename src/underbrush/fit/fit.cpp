#include "underbrush/fit/fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::fit {
namespace {

/// Margin around a tile in which points help to tell its ground and its surfaces.
constexpr double kMarginM = 10;

/// The hybrid without its ellipsoids.
constexpr std::string_view kGroundMesh = "ground_mesh";

/// Points of all hits by tile, relative to `origin`.
/// Gives the largest range among them.
double gather(BeamSource& source, const Vec3& origin, double min_range_m, TileStore& store,
              FitReport& report, const FitProgress& progress) {
  float largest = 0;
  source.rewind();
  BeamLog chunk;
  while (source.next(chunk)) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (!chunk.is_hit(i)) continue;
      ++report.hits;
      if (double(chunk.range_m[i]) < min_range_m) {
        ++report.near_points;
        continue;
      }
      largest = std::max(largest, chunk.range_m[i]);
      store.add(
          {(chunk.end_point(i) - origin).cast<float>(), -chunk.range_m[i] * chunk.direction[i]});
    }
    report.beams += chunk.size();
    if (progress) progress("gather", report.beams, source.size());
  }
  report.misses = report.beams - report.hits;
  report.thinned_points = store.thinned();
  report.tiles = store.tiles().size();
  return largest;
}

/// The world origin of a model: near the first beam, on whole metres.
Vec3 model_origin(BeamSource& source) {
  source.rewind();
  BeamLog chunk;
  require(source.next(chunk), "fit: the log is empty");
  return chunk.origin[0].array().round();
}

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

VolumetricOptions volumetric_options(const FitOptions& options) {
  VolumetricOptions out = options.volumetric;
  out.ellipsoid.floor_m = out.top_down.noise_m = options.range_noise_m;
  out.top_down.tau = options.tau;
  return out;
}

/// Tiles of whole voxels, so that no border cuts one.
TileOptions tile_options(const FitOptions& options) {
  TileOptions out = options.tiles;
  const double side = options.volumetric.voxel.side_m;
  if (options.fitter == "voxel" && side > 0) {
    out.tile_m = side * std::max(1.0, std::round(out.tile_m / side));
  }
  return out;
}

/// Which of a tile's points are ground, and where those lie (world).
struct TileGround {
  std::vector<bool> is_ground;
  std::vector<Vec3> points;
};

TileGround ground_of_tile(const TileStore& store, TileKey key, const Vec3& origin,
                          const FitOptions& options) {
  const TileStore::Loaded loaded = store.load(key, kMarginM);
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
  // The residuals already hold the sensor's noise.
  mesh.range_sigma_m = std::max(heights.sigma_m, options.range_noise_m);
  return mesh;
}

void fit_hybrid(const TileStore& store, const FitOptions& options, elements::Model& model,
                FitReport& report, const FitProgress& progress) {
  const std::vector<TileKey> tiles = store.tiles();
  ground::HeightGrid grid(model.origin, options.ground);
  std::vector<std::vector<bool>> is_ground;
  for_tiles_in_order<TileGround>(
      tiles, progress, "find ground",
      [&](size_t k) { return ground_of_tile(store, tiles[k], model.origin, options); },
      [&](TileGround tile) {
        grid.add(tile.points);
        report.ground_points += tile.points.size();
        is_ground.push_back(std::move(tile.is_ground));
      });
  report.other_points = store.size() - store.thinned() - report.ground_points;
  const auto fit_ground = [&] {
    if (grid.points() > 0) model.ground = mesh_of_ground(grid.solve(), options);
  };
  const auto fit_volumes = [&] {
    if (options.fitter == kGroundMesh) return;
    for_tiles_in_order<Volumes>(
        tiles, progress, "fit tiles",
        [&](size_t k) { return volumes_of_tile(store, tiles[k], is_ground[k], options); },
        [&](const Volumes& tile) {
          model.ellipsoids.insert(model.ellipsoids.end(), tile.ellipsoids.begin(),
                                  tile.ellipsoids.end());
          report.unclustered_points += tile.unclustered_points;
        });
  };
  parallel_invoke(fit_ground, fit_volumes);
  if (grid.points() == 0) {
    report.warnings.push_back("no ground was found: the model has no ground mesh");
  }
}

void drop_free_space(const FitOptions& options, elements::Model& model, FitReport& report) {
  report.free_space_ellipsoids = std::erase_if(model.ellipsoids, [&](const elements::Ellipsoid& e) {
    const double beams = double(e.hit.hits) + e.hit.misses;
    return beams >= options.free_space_beams && e.hit.hits < options.free_space_below * beams;
  });
}

/// Drops surface triangles that more beams passed than ended at; the others stay opaque.
void carve(BeamSource& source, const FitOptions& options, elements::Model& model, FitReport& report,
           const FitProgress& progress) {
  count_hits(model, source, options.credit, [&](size_t done, size_t total) {
    if (progress) progress("carve", done, total);
  });
  elements::TriangleMesh& mesh = model.surface;
  size_t kept = 0;
  for (size_t t = 0; t < mesh.size(); ++t) {
    if (mesh.hit[t].misses <= mesh.hit[t].hits) mesh.triangles[kept++] = mesh.triangles[t];
  }
  report.carved_triangles = mesh.size() - kept;
  mesh.triangles.resize(kept);
  mesh.hit.assign(kept, {});
}

void fit_surface(const TileStore& store, const FitOptions& options, const SignedDistance& distance,
                 elements::Model& model, FitReport& report, const FitProgress& progress) {
  const std::vector<TileKey> tiles = store.tiles();
  const double margin = surface_margin_m(options.surface);
  double squares = 0;
  size_t points = 0;
  for_tiles_in_order<SurfaceTile>(
      tiles, progress, "fit tiles",
      [&](size_t k) {
        const TileStore::Loaded loaded = store.load(tiles[k], margin);
        const Eigen::Vector2d lo = store.corner(tiles[k]);
        const double side = options.tiles.tile_m;
        return surface_tile(loaded.point, loaded.to_sensor,
                            {lo.x(), lo.y(), lo.x() + side, lo.y() + side}, options.surface,
                            distance);
      },
      [&](SurfaceTile tile) {
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
  const double about_surface = points ? std::sqrt(squares / double(points)) : 0;
  model.surface.range_sigma_m = options.surface.noise_m > 0
                                    ? options.surface.noise_m
                                    : std::max(about_surface, options.range_noise_m);
  report.other_points = store.size();
}

FitResult fit_likelihood(BeamSource& source, FitOptions options, const FitProgress& progress) {
  require(options.start != "likelihood", "fit: likelihood needs another fitter to start with");
  options.fitter = options.start;
  // Points are shared by what follows; only a footprint is for the start to take away.
  if (!options.volumetric.mixture.footprint) options.volumetric.mixture.rounds = 0;
  const LikelihoodOptions refinement = likelihood_options(options);
  TrainingSource training(source, refinement.held_out);
  FitResult out = fit(training, options, progress);
  Refined refined = refine(out.model, source, refinement, progress);
  out.model = std::move(refined.model);
  out.model.fitter = "likelihood";
  out.report.likelihood = std::move(refined.report);
  return out;
}

}  // namespace

std::vector<std::string> fitter_names() {
  std::vector<std::string> names = volumetric_fitters();
  names.insert(names.end(), {std::string(kGroundMesh), "surface", "rimls", "likelihood"});
  return names;
}

LikelihoodOptions likelihood_options(const FitOptions& options) {
  LikelihoodOptions out = options.likelihood;
  out.range_noise_m = out.maximisation.floor_m = options.range_noise_m;
  out.held_out.seed = options.seed;
  return out;
}

FitResult fit(BeamSource& source, const FitOptions& options, const FitProgress& progress) {
  require(options.tau > 0, "fit: tau must be positive");
  require(options.range_noise_m > 0, "fit: the range noise must be positive");
  if (options.fitter == "likelihood") return fit_likelihood(source, options, progress);
  FitResult out;
  elements::Model& model = out.model;
  model.fitter = options.fitter;
  model.tau = options.tau;
  if (options.fitter == "voxel" && options.volumetric.voxel.bounded) {
    model.voxel_m = options.volumetric.voxel.side_m;
  }
  model.origin = model_origin(source);
  TileStore store(tile_options(options));
  model.max_range_m =
      gather(source, model.origin, options.min_range_m, store, out.report, progress);
  require(store.size() > 0, "fit: the log has no return to fit a model to");
  if (!source.info().has_misses) {
    out.report.warnings.push_back(
        "the log has no misses, so hit probabilities come out too high; import it with "
        "--infer-misses SENSOR if its format drops them");
  }
  if (options.volumetric.mixture.footprint && options.fitter != "hierarchical") {
    out.report.warnings.push_back(
        "the sensor's footprint is taken out of the ellipsoids of hierarchical alone, not of those "
        "of " +
        options.fitter);
  }
  const std::vector<std::string> volumetric = volumetric_fitters();
  if (options.fitter == kGroundMesh ||
      std::count(volumetric.begin(), volumetric.end(), options.fitter)) {
    fit_hybrid(store, options, model, out.report, progress);
    count_hits(model, source, options.credit, [&](size_t done, size_t total) {
      if (progress) progress("count hits", done, total);
    });
    drop_free_space(options, model, out.report);
  } else if (options.fitter == "surface" || options.fitter == "rimls") {
    fit_surface(store, options, options.fitter == "rimls" ? rimls : imls, model, out.report,
                progress);
    if (options.surface.carve) carve(source, options, model, out.report, progress);
  } else {
    throw std::invalid_argument("fit: no fitter '" + options.fitter + "'");
  }
  return out;
}

}  // namespace underbrush::fit
