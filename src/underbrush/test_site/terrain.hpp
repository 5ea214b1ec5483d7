/// \file
/// The ground of the test site: hilly relief with a track through it.
#pragma once
#include <array>
#include <cstdint>
#include <functional>

#include "underbrush/core/cells.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::test_site {

/// Parameters of `Terrain`.
struct TerrainParameters {
  double size_x_m = 60;  ///< m; the site is centred at the origin, and the track crosses it along
                         ///< x.
  double size_y_m = 40;
  double relief_m = 0.7;  ///< m; standard deviation of the height.
  double slope = 0.04;    ///< Slope of the mean plane, towards a direction drawn from the seed.
  double roughness_m = 0.015;  ///< m; standard deviation of the waves shorter than 3 m, off the
                               ///< track.
  double track_half_width_m = 1.5;
};

/// A smooth height field over the whole plane, with wavelengths in [0.8, 45] m. The track is cut in
/// by 8 cm, and short waves are damped on it.
class Terrain {
 public:
  /// Throws `std::invalid_argument` for sizes that are not positive or deviations that are
  /// negative.
  Terrain(const TerrainParameters& parameters, uint64_t seed);

  const TerrainParameters& parameters() const { return parameters_; }
  /// Returns the height (m) at (x, y).
  double height(double x, double y) const;
  /// Returns the unit normal at (x, y), which points upwards.
  Vec3 normal(double x, double y) const;

  /// Returns y (m) of the track's middle line at x. The track meanders over a quarter of the site's
  /// width.
  double track_y(double x) const;
  /// Returns dy/dx of the middle line at x.
  double track_slope(double x) const;
  /// Returns the distance (m) from (x, y) to the middle line.
  double distance_to_track(double x, double y) const;

  /// Returns the ground of the site and of `margin_m` around it as a grid of triangles of side
  /// `spacing_m`. Throws `std::invalid_argument` for a spacing that is not positive, a negative
  /// margin, or 10⁹ cells and more.
  elements::TriangleMesh mesh(double spacing_m, double margin_m) const;
  /// The columns and rows of that grid.
  Cell2 grid(double spacing_m, double margin_m) const;
  /// The columns [first.x, end.x) and the rows [first.y, end.y) of that grid.
  elements::TriangleMesh mesh(double spacing_m, double margin_m, Cell2 first, Cell2 end) const;

 private:
  struct Wave {
    double kx, ky, phase, amplitude;
  };
  Eigen::Vector2d size_m(double margin_m) const;

  TerrainParameters parameters_;
  std::array<Wave, 16> long_;
  std::array<Wave, 12> short_;
  std::array<double, 2> plane_, track_phase_;
};

/// Returns the surface z = height(x, y) over the rectangle of that length and width (m) about the
/// origin, as a grid of triangles of side `spacing_m` (m) at most. `height` is called on all
/// threads. Throws `std::invalid_argument` for sides or a spacing that are not positive, and for
/// 10⁹ cells and more.
elements::TriangleMesh mesh_of_heights(const Eigen::Vector2d& size_m, double spacing_m,
                                       const std::function<double(double, double)>& height);

}  // namespace underbrush::test_site
