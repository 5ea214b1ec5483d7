/// \file
/// The ground of the test site: rolling relief with a track through it.
#pragma once
#include <array>
#include <cstdint>

#include "underbrush/elements/model.hpp"

namespace underbrush::test_site {

/// Extent and shape of the ground.
struct TerrainParameters {
  double size_x_m = 60;  ///< The site is centred at the origin; the track crosses it along x.
  double size_y_m = 40;
  double relief_m = 0.7;       ///< Standard deviation of the height.
  double slope = 0.04;         ///< Of the mean plane, towards a direction drawn from the seed.
  double roughness_m = 0.015;  ///< Standard deviation of the part shorter than 3 m, off the track.
  double track_half_width_m = 1.5;
};

/// A height field over the whole plane, smooth, with wavelengths in [0.8, 45] m; on the track it is
/// cut in by 8 cm and the short waves are damped.
class Terrain {
 public:
  /// Throws `std::invalid_argument` on sizes that are not positive.
  Terrain(const TerrainParameters& parameters, uint64_t seed);

  const TerrainParameters& parameters() const { return parameters_; }
  /// m.
  double height(double x, double y) const;
  /// Unit, upwards.
  Vec3 normal(double x, double y) const;

  /// y (m) of the track's middle line at x; it meanders over a quarter of the site's width.
  double track_y(double x) const;
  /// dy/dx of the middle line.
  double track_slope(double x) const;
  /// Distance (m) to the middle line.
  double distance_to_track(double x, double y) const;

  /// The ground within `margin_m` around the site as a grid of triangles of side `spacing_m`.
  elements::TriangleMesh mesh(double spacing_m, double margin_m) const;

 private:
  struct Wave {
    double kx, ky, phase, amplitude;
  };
  TerrainParameters parameters_;
  std::array<Wave, 16> long_;
  std::array<Wave, 12> short_;
  std::array<double, 2> plane_, track_phase_;
};

}  // namespace underbrush::test_site
