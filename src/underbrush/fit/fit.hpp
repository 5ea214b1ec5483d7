/// \file
/// This file declares `fit`, which turns a log into a model: it sorts points into tiles, tells
/// ground from the rest, makes elements of both, and estimates hit probabilities from the beams.
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/tile_store.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/fit/fit_record.hpp"
#include "underbrush/fit/hit_probability.hpp"
#include "underbrush/fit/keyframes.hpp"
#include "underbrush/fit/likelihood.hpp"
#include "underbrush/fit/surface.hpp"
#include "underbrush/fit/volumetric.hpp"
#include "underbrush/ground/height_grid.hpp"
#include "underbrush/ground/segment.hpp"
#include "underbrush/ground/triangulate.hpp"

namespace underbrush::fit {

/// The parameters θ of a fit.
struct FitOptions {
  /// The name of a fitter in the table of fit/fitters.hpp:
  /// - `hierarchical` ([tallavajhula18]), `voxel`, `top_down` and `bottom_up` ([deschaud12]) make a
  ///   ground mesh and ellipsoids;
  /// - `ground_mesh` makes the ground mesh alone;
  /// - `surface` makes one opaque mesh through all points, the everyday baseline, and `rimls` does
  ///   so with the robust implicit surface of [deschaud12];
  /// - `likelihood` refines the model of `start` by `refine`.
  std::string fitter = "likelihood";
  /// For `likelihood` only: the fitter that makes the first model, or the folder of a model.
  std::string start = "hierarchical";
  /// The sensor that recorded the log, as in `LogInfo`; empty: as the log says.
  std::string sensor, sensor_file;
  uint64_t seed = 1;
  double tau = 3;               ///< A beam meets an ellipsoid within this Mahalanobis distance.
  double range_noise_m = 0.02;  ///< σ of the sensor's range, m: the least extent of any element.
  /// Returns nearer than this are left out (m), because they come from the vehicle that carries the
  /// sensor. The vehicle soon stands where its sensor was before, and an opaque model of it would
  /// enclose the sensor there.
  double min_range_m = 0;
  /// Unless this is set, the range offsets of the sensor's channels are learnt first
  /// (`learn_offsets`), taken away from the ranges and kept in the model. Logs that do not name
  /// their sensor have none.
  bool ranges_as_given = false;
  /// Ellipsoids through which nearly all beams passed are dropped as free space: something moved
  /// through it once. An ellipsoid is dropped where hits / (hits + misses) is below this and at
  /// least `free_space_beams` beams met it.
  double free_space_below = 0.05;
  uint32_t free_space_beams = 20;
  TileOptions tiles;
  ground::SegmentOptions segment;
  ground::HeightGridOptions ground;
  ground::TriangulateOptions triangulate;
  /// `fit` sets the floor of the covariances, and the noise and τ of `top_down`, from the fields
  /// above.
  VolumetricOptions volumetric;
  CreditOptions credit;
  SurfaceOptions surface;
  /// `fit` sets its range noise and its floor from the fields above.
  LikelihoodOptions likelihood;
  /// For `likelihood` only; other fitters keep none. `fit` sets its least range from the field
  /// above.
  KeyframeOptions keyframes;
};

/// Counts and warnings of a fit.
struct FitReport {
  size_t beams = 0, hits = 0, misses = 0;
  size_t ground_points = 0, other_points = 0;
  size_t mover_points = 0;           ///< Left out because they have the flag `kMover`.
  size_t near_points = 0;            ///< Left out because they are nearer than `min_range_m`.
  size_t carved_triangles = 0;       ///< Dropped because of `surface.carve`.
  size_t thinned_points = 0;         ///< Left out because their tile was full.
  size_t unclustered_points = 0;     ///< In no cluster of at least `min_points`.
  size_t free_space_ellipsoids = 0;  ///< Dropped as free space.
  size_t tiles = 0;
  LikelihoodReport likelihood;  ///< Has steps only if the fitter is `likelihood`.
  std::vector<std::string> warnings;
};

/// A model, the report of its fit, and what `update` needs to know of it.
struct FitResult {
  elements::Model model;
  FitReport report;
  FitRecord record;
};

/// Receives the progress of a fit: the name of the stage, the work done and the total.
using FitProgress = std::function<void(std::string_view, size_t, size_t)>;

/// The names of the fitters, in the order of the table.
std::vector<std::string> fitter_names();

/// Fits a model to a log, with its classes (`learn_classes`) and its light (`learn_light`) where
/// the log has labels and intensities. A log of up to 384 MiB (some six million beams) is read once
/// and stays in memory. A longer one is read for the channels, twice for the geometry (`likelihood`
/// reads it once more, and a long one in each step), for classes and for the light; memory grows
/// with a tile and the model, not with the log. The result has the same bits for any number
/// of threads. `progress` may be empty. Throws `std::invalid_argument` for an unknown fitter, for
/// options out of range and for a log without returns.
FitResult fit(BeamSource& source, const FitOptions& options, const FitProgress& progress = {});

/// The options of the fitter that makes the first model of a refinement; for a fitter that does not
/// refine, its own.
FitOptions start_options(FitOptions options);

/// The options that `fit` passes to `refine`: `options.likelihood` with the range noise, the floor
/// and the seed filled in.
LikelihoodOptions likelihood_options(const FitOptions& options);

/// The options that `fit` passes to `learn_keyframes`.
KeyframeOptions keyframe_options(const FitOptions& options);

}  // namespace underbrush::fit
