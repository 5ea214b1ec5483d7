/// \file
/// The beam of a lidar: an infinitely thin ray, a random ray of its cone, or many sub-rays over its
/// cross-section with weights that sum to one.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/core/ray.hpp"

namespace underbrush::sensor {

/// How energy spreads over the cross-section. A place (u, v) on it is in units of half the full
/// width, u horizontal, v vertical, so that the divergence and the exit diameter are at |(u, v)| =
/// 1.
enum class Profile : uint8_t {
  kUniform,   ///< Even on the unit disc.
  kGaussian,  ///< ∝ 2^−(u² + v²): the widths are full widths at half power.
  kTable,     ///< `BeamShape::table` over the square [−1, 1]².
};

/// How the beam's half-width grows with the range R from its half-width w₀ at the exit.
enum class Growth : uint8_t {
  kCone,  ///< w₀ + R tan(γ/2): a truncated cone.
  kWaist,  ///< √(w₀² + R² tan²(γ/2)): a Gaussian beam. Its sub-rays are the lines of a hyperboloid.
};

/// The shape of a beam.
struct BeamShape {
  std::array<double, 2> divergence_rad{};  ///< Full angle γ: horizontal, vertical.
  double exit_diameter_m = 0;              ///< Full width where it leaves the sensor.
  Profile profile = Profile::kUniform;
  Growth growth = Growth::kCone;
  /// Energy per cell in rows of `table_columns`, u rising within a row, v rising from row to row.
  std::vector<double> table;
  int table_columns = 0;
  double encoder_step_rad = 0;  ///< The true azimuth lies evenly within ± half of this.

  /// Half-width (m) at range R: horizontal, vertical.
  std::array<double, 2> half_width_m(double range_m) const;
  /// Standard deviation (m) of a place on the cross-section at range R: horizontal, vertical.
  std::array<double, 2> sigma_m(double range_m) const;
  /// Throws `std::invalid_argument` where a value is negative or not finite, or the table is not a
  /// whole number of rows with some energy.
  void check() const;
};

/// A round, even beam.
inline BeamShape round_beam(double divergence_rad, double exit_diameter_m) {
  BeamShape shape;
  shape.divergence_rad = {divergence_rad, divergence_rad};
  shape.exit_diameter_m = exit_diameter_m;
  return shape;
}

/// A place on the cross-section and its share of the energy.
struct SubRay {
  float u = 0, v = 0, weight = 1;
};

/// `shares` (≥ 0, some > 0) scaled to sum to one exactly, in float and in any order of summation:
/// each is a multiple of 2⁻²⁴, by the largest remainder.
std::vector<float> exact_weights(std::span<const double> shares);

/// `n` ≥ 1 sub-rays of equal weight, spread over the profile like the seeds of a sunflower. Not for
/// tables. Throws `std::invalid_argument`.
std::vector<SubRay> spread_sub_rays(const BeamShape& shape, int n);

/// Up to `columns` × `rows` sub-rays ([rosenberger20] §3.2): cells of a grid over the profile (a
/// Gaussian to 2.5 half-widths), each at its centre of energy with the cell's energy as weight;
/// cells without energy are left out. Throws `std::invalid_argument`.
std::vector<SubRay> grid_sub_rays(const BeamShape& shape, int columns, int rows);

/// A beam's axis, with the two directions across it.
struct BeamAxes {
  Ray axis;
  Vec3 right, up;  ///< Of u and v; unit, perpendicular to the axis and to each other.
  Vec3 vertical;   ///< What the encoder's angle turns about; unit.
};

/// u is perpendicular to `vertical`, v as near to it as the axis allows; any pair where the axis is
/// along it.
BeamAxes beam_axes(const Ray& axis, const Vec3& vertical = Vec3::UnitZ());

/// A shape made ready to give rays: no angle function and one division a ray.
class RayMaker {
 public:
  explicit RayMaker(const BeamShape& shape);
  /// The ray through the place (u, v) of the cross-section.
  Ray ray(const BeamAxes& beam, double u, double v) const;

 private:
  double exit_m_, slope_u_, slope_v_;
  bool cone_;
};

/// A ray drawn from the beam's profile and its encoder's step ([deschaud12] §IV draws evenly from
/// the truncated cone: `kUniform`, `kCone`). Random numbers: elements 0 to 2 of
/// `Purpose::kDirection`.
Ray random_ray(const BeamAxes& beam, const BeamShape& shape, uint64_t key);

}  // namespace underbrush::sensor
