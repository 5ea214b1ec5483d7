/// \file
/// This file describes the beam of a lidar. A simulation can take it as an infinitely thin ray, as
/// a random ray of its cone, or as many sub-rays over its cross-section with weights that sum to
/// one.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/core/ray.hpp"

namespace underbrush::sensor {

/// The distribution of energy over the beam's cross-section. A place (u, v) on the cross-section is
/// in units of the beam's half-width, with u horizontal and v vertical, so that |(u, v)| = 1 is
/// where the divergence and the exit diameter are measured.
enum class Profile : uint8_t {
  kUniform,   ///< Constant on the unit disc.
  kGaussian,  ///< ∝ 2^−(u² + v²): the widths are full widths at half power.
  kTable,     ///< `BeamShape::table` over the square [−1, 1]².
};

/// The growth of the beam's half-width with the range R, from its half-width w₀ at the exit and its
/// full divergence γ.
enum class Growth : uint8_t {
  kCone,  ///< w₀ + R tan(γ/2): a truncated cone.
  /// √(w₀² + R² tan²(γ/2)): a Gaussian beam, whose sub-rays are the lines of a hyperboloid.
  kWaist,
};

/// The shape of a beam.
struct BeamShape {
  std::array<double, 2> divergence_rad{};  ///< Full angle γ, horizontal and vertical.
  double exit_diameter_m = 0;              ///< Full width where the beam leaves the sensor.
  Profile profile = Profile::kUniform;
  Growth growth = Growth::kCone;
  /// Energy of each cell of a `kTable` profile, in rows of `table_columns`. u rises within a row,
  /// and v from row to row.
  std::vector<double> table;
  int table_columns = 0;
  double encoder_step_rad = 0;  ///< The true azimuth is spread evenly within ± half of this.

  /// The half-width at a range, horizontal and vertical, m.
  std::array<double, 2> half_width_m(double range_m) const;
  /// The standard deviation of a ray's place on the cross-section at a range, horizontal and
  /// vertical, m.
  std::array<double, 2> sigma_m(double range_m) const;
  /// Throws `std::invalid_argument` where a value is negative or not finite, or where the table has
  /// no energy or no whole number of rows.
  void check() const;
};

/// Makes a round beam with a uniform profile.
inline BeamShape round_beam(double divergence_rad, double exit_diameter_m) {
  BeamShape shape;
  shape.divergence_rad = {divergence_rad, divergence_rad};
  shape.exit_diameter_m = exit_diameter_m;
  return shape;
}

/// A place on the cross-section and its share of the beam's energy.
struct SubRay {
  float u = 0, v = 0, weight = 1;
};

/// Scales shares (≥ 0, some > 0) to weights that sum to exactly one in float, in any order of
/// summation. Each weight is a multiple of 2⁻²⁴, found by the method of the largest remainder.
std::vector<float> exact_weights(std::span<const double> shares);

/// Makes `n` ≥ 1 sub-rays of equal weight, which are spread over the profile in a sunflower spiral.
/// Throws `std::invalid_argument` for a table profile and for values out of range.
std::vector<SubRay> spread_sub_rays(const BeamShape& shape, int n);

inline constexpr int kMostSubRayLines = 1024;  ///< Most columns and most rows of sub-rays.
/// Makes up to `columns` × `rows` sub-rays from a grid over the profile, as in [rosenberger20]
/// §3.2. A Gaussian is cut at 2.5 half-widths. Each sub-ray is at its cell's centre of energy and
/// has the cell's energy as weight; cells without energy are left out. Throws
/// `std::invalid_argument` for values out of range.
std::vector<SubRay> grid_sub_rays(const BeamShape& shape, int columns, int rows);

/// The axis of a beam and two directions across it.
struct BeamAxes {
  Ray axis;
  /// The directions of u and v: unit vectors, perpendicular to the axis and to each other.
  Vec3 right, up;
  Vec3 vertical;  ///< The axis of the encoder's angle, a unit vector.
};

/// Computes the axes of a beam. u is perpendicular to `vertical`, and v is as near to it as the
/// axis allows. Where the axis is parallel to `vertical`, any pair is taken.
BeamAxes beam_axes(const Ray& axis, const Vec3& vertical = Vec3::UnitZ());

/// A beam shape prepared for making many rays quickly. A ray costs one division and no
/// trigonometric function.
class RayMaker {
 public:
  explicit RayMaker(const BeamShape& shape);
  /// The ray through the place (u, v) of the cross-section.
  Ray ray(const BeamAxes& beam, double u, double v) const;

 private:
  double exit_m_, slope_u_, slope_v_;
  bool cone_;
};

/// Draws a ray from the beam's profile and its encoder's step. [deschaud12] §IV draws evenly from
/// the truncated cone, which is `kUniform` with `kCone`. The random numbers are elements 0 to 2 of
/// `Purpose::kDirection` of `key`.
Ray random_ray(const BeamAxes& beam, const BeamShape& shape, uint64_t key);

}  // namespace underbrush::sensor
