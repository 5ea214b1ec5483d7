/// \file
/// The options of `fit`.
#pragma once
#include <cstdint>
#include <string>

#include "underbrush/cluster/volumetric.hpp"
#include "underbrush/core/tile_store.hpp"
#include "underbrush/credit/hit_probability.hpp"
#include "underbrush/ground/height_grid_options.hpp"
#include "underbrush/ground/segment.hpp"
#include "underbrush/ground/triangulate.hpp"
#include "underbrush/keyframes/keyframe_options.hpp"
#include "underbrush/likelihood/likelihood.hpp"
#include "underbrush/surface/surface.hpp"

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
  /// For `likelihood` only: how much of a long log is used (`Effort`).
  std::string effort = "medium";
  /// Whether every echo is a beam of its own. Otherwise each beam ends at its first echo.
  bool all_echoes = false;
  /// Whether the grain of the matter is learnt (`calibrate::learn_grain`, and from several echoes a
  /// beam `calibrate::learn_grain_of_echoes`). Otherwise it is the usual one.
  bool learn_grain = true;
  /// The sensor that recorded the log, as in `LogInfo`. If empty, it is the sensor that the log
  /// names.
  std::string sensor, sensor_file;
  uint64_t seed = 1;
  double tau = 3;  ///< A beam meets an ellipsoid within this Mahalanobis distance.
  /// σ of the sensor's range, m. Where a sensor that stands still shows less, `fit` takes that
  /// (`calibrate::range_noise_of`).
  double range_noise_m = 0.02;
  /// Returns nearer than this are left out (m), because they come from the vehicle that carries the
  /// sensor. The vehicle soon stands where its sensor was before, and an opaque model of it would
  /// enclose the sensor there.
  double min_range_m = 0;
  /// Unless this is set, the range offsets of the sensor's channels are learnt first
  /// (`learn_offsets`), taken away from the ranges and kept in the model. Logs that do not name
  /// their sensor have none.
  bool ranges_as_given = false;
  /// Ellipsoids of things that moved away are dropped as free space. An ellipsoid is dropped where
  /// hits / (hits + misses) is below this, at least `free_space_beams` beams met it, and its hits
  /// came within a short part of the time (`credit::TrialTimes::are_brief`), which those of thin
  /// matter do not.
  double free_space_below = 0.2;
  uint32_t free_space_beams = 20;
  /// m; side of the cells of the map of observed space (`calibrate::learn_observed_space`), for
  /// `likelihood` only; 0 = none, so that unknown space counts as empty.
  double unknown_cell_m = 1;
  TileOptions tiles;
  /// What rises more than 5 cm above the ground is better described by ellipsoids, which beams
  /// pass.
  ground::SegmentOptions segment{.lower_envelope = {.above_m = 0.05}, .spherical_variance = {}};
  ground::HeightGridOptions ground;
  ground::TriangulateOptions triangulate;
  /// `fit` sets the least sizes, and the noise of `top_down`, from `range_noise_m`.
  cluster::VolumetricOptions volumetric;
  credit::CreditOptions credit;
  surface::SurfaceOptions surface;
  /// `fit` sets its range noise and its floor from the fields above.
  likelihood::LikelihoodOptions likelihood;
  /// For `likelihood` only, and not from all echoes; others keep none. `fit` sets its least range
  /// from the field above.
  keyframes::KeyframeOptions keyframes;
};

}  // namespace underbrush::fit
