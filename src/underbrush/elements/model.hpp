/// \file
/// The world model that a fitter learns and a simulator answers from: scene elements e = (ρ, ω)
/// with geometry ρ and sensor parameters ω ([tallavajhula18] §III).
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush {
/// Scene elements and the model that holds them.
namespace elements {

/// How often beams that met an element ended at it (hits) or went on (misses), and the hit
/// probability learnt from that; permeability ([deschaud12] §III) = 1 − p.
struct HitCount {
  float p = 1;
  uint32_t hits = 0;
  uint32_t misses = 0;
};

/// Triangles with one hit probability each and one range noise for all.
struct TriangleMesh {
  std::vector<Vec3f> vertices;                     ///< m, relative to the model's origin.
  std::vector<std::array<uint32_t, 3>> triangles;  ///< Indices into `vertices`.
  std::vector<HitCount> hit;                       ///< One per triangle.
  double range_sigma_m = 0;                        ///< σ of the range about the surface.
  /// h: σ of what the surface rises and falls about the mesh, along its normal. A beam at angle of
  /// incidence θ then has the range σ² = range_sigma_m² + (h / max(|cos θ|, 0.01))².
  double roughness_m = 0;

  size_t size() const { return triangles.size(); }
};

/// A permeable Gaussian volume ω = (μ, Σ, p_hit).
struct Ellipsoid {
  Vec3f mean = Vec3f::Zero();                         ///< μ, m, relative to the model's origin.
  std::array<float, 6> covariance{1, 0, 0, 1, 0, 1};  ///< Σ, m²: xx xy xz yy yz zz.
  HitCount hit;
  uint32_t label = 0;  ///< Class of the points it was fitted to, 0 = unknown.
  /// κ (1/m): if positive, the hit probability depends on how much of the volume a beam crosses,
  /// p(δ) = 1 − exp(−κ √(2π) σ e^{−δ²/2}) with σ the standard deviation along the beam, and `hit.p`
  /// is not used.
  float density_per_m = 0;

  Mat3 covariance_matrix() const;
  void set_covariance(const Mat3& sigma);
};

/// Kind of a scene element, in the order in which a model numbers its elements.
enum class Kind : uint8_t { kGround, kSurface, kEllipsoid };

/// Where a model keeps an element: the array of its kind and its index there.
struct ElementPlace {
  Kind kind = Kind::kGround;
  uint32_t index = 0;
};

/// A learnt world. Elements are numbered: ground triangles, then surface triangles, then
/// ellipsoids.
struct Model {
  Vec3 origin = Vec3::Zero();  ///< m, world; all coordinates below are relative to it.
  TriangleMesh ground;
  TriangleMesh surface;  ///< Opaque or permeable triangles that are not ground.
  std::vector<Ellipsoid> ellipsoids;
  double tau = 3.5;  ///< A beam meets an ellipsoid within this Mahalanobis distance.
  /// Side (m) of the cells of a voxel model ([deschaud12] §III.C.1), 0 for none: an ellipsoid then
  /// counts only where the closest approach lies in the cell that holds its mean, the cells being
  /// those of a grid through the model's origin.
  double voxel_m = 0;
  /// Largest range (m) at which the log that it was fitted to has a return: where sensor or format
  /// end. Infinite where nothing is known.
  double max_range_m = std::numeric_limits<double>::infinity();
  std::string fitter;      ///< Name of the fitter that made it.
  std::string provenance;  ///< JSON object: program version, command, seed, input hashes.

  size_t size() const { return ground.size() + surface.size() + ellipsoids.size(); }
  /// Number of triangles, and so of the first ellipsoid.
  size_t triangle_count() const { return ground.size() + surface.size(); }
  /// The place of the element of this number; numbers are not checked.
  ElementPlace place(size_t element) const {
    if (element < ground.size()) return {Kind::kGround, uint32_t(element)};
    if (element < triangle_count()) return {Kind::kSurface, uint32_t(element - ground.size())};
    return {Kind::kEllipsoid, uint32_t(element - triangle_count())};
  }
  Kind kind(size_t element) const { return place(element).kind; }
  /// The mesh of `Kind::kGround` or `Kind::kSurface`.
  const TriangleMesh& mesh(Kind kind) const { return kind == Kind::kGround ? ground : surface; }
  HitCount& hit(size_t element);
  const HitCount& hit(size_t element) const;
  /// Throws `std::invalid_argument` where a value is not finite, an index is out of range, a
  /// probability outside [0, 1] or a covariance not positive definite.
  void check() const;
};

/// The covariance with its eigenvalues raised to at least `floor_m`² (flat, thin or few points):
/// the noise of the sensor, below which no extent can be told. Symmetric in, symmetric out.
Mat3 floored_covariance(const Mat3& sigma, double floor_m);

}  // namespace elements
}  // namespace underbrush
