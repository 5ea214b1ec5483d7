/// \file
/// From a log to a model: gather points by tile, tell ground from the rest, fit each, count hits.
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/tile_store.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/fit/hit_probability.hpp"
#include "underbrush/fit/likelihood.hpp"
#include "underbrush/fit/surface.hpp"
#include "underbrush/fit/volumetric.hpp"
#include "underbrush/ground/height_grid.hpp"
#include "underbrush/ground/segment.hpp"
#include "underbrush/ground/triangulate.hpp"

namespace underbrush::fit {

/// Parameters θ of a fit.
struct FitOptions {
  /// `hierarchical` ([tallavajhula18]), `voxel`, `top_down`, `bottom_up` ([deschaud12]): ground
  /// mesh + ellipsoids; `ground_mesh`: the same without ellipsoids; `surface`: one opaque mesh over
  /// everything, the everyday baseline; `rimls`: the same by the robust implicit of [deschaud12];
  /// `likelihood`: what `start` gives, refined by `refine`. See fit/fitters.hpp.
  std::string fitter = "hierarchical";
  /// `likelihood`: the fitter that comes first, or the folder of a model to begin with.
  std::string start = "hierarchical";
  uint64_t seed = 1;
  double tau = 3;               ///< A beam meets an ellipsoid within this Mahalanobis distance.
  double range_noise_m = 0.02;  ///< σ of the sensor's range: the floor of every extent.
  /// Nearer returns are left out: the vehicle that carries the sensor. It stands where its sensor
  /// was a moment ago, and an opaque model would enclose the sensor there.
  double min_range_m = 0;
  /// Ellipsoids through which nearly all beams passed are free space that something crossed once:
  /// dropped where hits / (hits + misses) is below this, with at least `free_space_beams` beams.
  double free_space_below = 0.05;
  uint32_t free_space_beams = 20;
  TileOptions tiles;
  ground::SegmentOptions segment;
  ground::HeightGridOptions ground;
  ground::TriangulateOptions triangulate;
  /// The floor of the covariances, the noise and the τ of `top_down` are set from the above.
  VolumetricOptions volumetric;
  CreditOptions credit;
  SurfaceOptions surface;
  /// The range noise and the floor are set from the above.
  LikelihoodOptions likelihood;
};

/// What happened during a fit.
struct FitReport {
  size_t beams = 0, hits = 0, misses = 0;
  size_t ground_points = 0, other_points = 0;
  size_t near_points = 0;            ///< Left out because they are nearer than `min_range_m`.
  size_t carved_triangles = 0;       ///< Dropped by `surface.carve`.
  size_t thinned_points = 0;         ///< Left out because their tile was full.
  size_t unclustered_points = 0;     ///< In no cluster of at least `min_points`.
  size_t free_space_ellipsoids = 0;  ///< Dropped as free space.
  size_t tiles = 0;
  LikelihoodReport likelihood;  ///< Steps: none but those of `likelihood`.
  std::vector<std::string> warnings;
};

/// A model and how it came to be.
struct FitResult {
  elements::Model model;
  FitReport report;
};

/// Called as a fit goes on: stage, done, total.
using FitProgress = std::function<void(std::string_view, size_t, size_t)>;

/// Names of the fitters.
std::vector<std::string> fitter_names();

/// Fits a model to a log; reads it twice, memory grows with a tile and the model, not with the log.
/// The same bits for any number of threads. Throws `std::invalid_argument` for an unknown fitter or
/// a log without any return.
FitResult fit(BeamSource& source, const FitOptions& options, const FitProgress& progress = {});

/// The options with which `fit` refines a model.
LikelihoodOptions likelihood_options(const FitOptions& options);

}  // namespace underbrush::fit
