/// \file
/// This file sums the sufficient statistics of each element over the beams of a log. The sums are
/// exact, so their bits depend neither on the order of the beams nor on the number of threads.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "underbrush/elements/model.hpp"
#include "underbrush/likelihood/beam_block.hpp"

namespace underbrush::likelihood {

/// A sum of doubles in fixed point, which is exact and so independent of the order of its terms.
/// The resolution is 2⁻²⁶. Terms are clamped to ±10⁴, which leaves room for 10⁷ terms of that size.
class FixedSum {
 public:
  FixedSum() = default;
  explicit FixedSum(int64_t bits) : bits_(bits) {}
  void add(double term);
  void add(const FixedSum& other) { bits_ += other.bits_; }
  /// Adds a term; any number of threads may do so at once.
  void add_shared(double term);
  void multiply(unsigned factor) { bits_ *= factor; }
  double value() const { return double(bits_) * 0x1p-26; }
  int64_t bits() const { return bits_; }
  bool operator==(const FixedSum&) const = default;

 private:
  int64_t bits_ = 0;
};

/// Derivatives of the expected log-likelihood by the parameters of one ellipsoid, with their Fisher
/// information ("curvature"). They are taken in the ellipsoid's whitened frame y = L⁻¹ (x − μ), Σ =
/// L Lᵀ, in which the ellipsoid moves to μ + L s, L (I + E) and κ e^k: s is a shift, E a symmetric
/// stretch, and k changes the density κ (1/m).
struct EllipsoidSums {
  double hits = 0;    ///< Σ r: sum of the shares returned by the ellipsoid.
  double passes = 0;  ///< Sum of the shares that went through the ellipsoid.
  double density_slope = 0, density_curvature = 0;  ///< Derivatives by k.
  Vec3 shift_slope = Vec3::Zero();                  ///< Slope by s.
  Mat3 shift_curvature = Mat3::Zero();              ///< Curvature by s.
  Mat3 stretch_slope = Mat3::Zero();                ///< Slope by E.
  /// Curvature by E; entry (i, j) belongs to entry (i, j) of E alone.
  Mat3 stretch_curvature = Mat3::Zero();
  /// Σ r x² n nᵀ, with the misfit x = (z − t)/σ and the whitened direction n of a beam.
  Mat3 along = Mat3::Zero();
};

/// The soft hits and passes of one triangle, and the derivative of the expected log-likelihood by
/// the logarithm of its roughness with its Fisher information.
struct TriangleSums {
  double hits = 0, passes = 0;
  double roughness_slope = 0, roughness_curvature = 0;
};

/// The derivative of the expected log-likelihood by the logarithm of a mesh's range_sigma_m, with
/// its Fisher information.
struct NoiseSums {
  double slope = 0, curvature = 0;
};

/// A model in the form of the inner loops.
class ModelForms {
 public:
  /// Beams meet elements from `min_range_m` (m) on. The model must outlive the forms.
  ModelForms(const elements::Model& model, double min_range_m);
  ModelForm view() const;

 private:
  const elements::Model& model_;
  double min_range_m_;
  std::vector<EllipsoidForm> ellipsoids_;
  std::vector<float> triangle_p_, roughness_variance_;
};

/// The shares of the beams of a block: those of the meetings by place, 0 where a beam does not meet
/// the element.
struct BlockShares {
  std::vector<float> hit, pass;
};

/// Exact sums for `NoiseSums`: slope, curvature.
using MeshNoise = std::array<FixedSum, 2>;

/// The sums of all elements of a model.
class ElementSums {
 public:
  ElementSums() = default;
  /// Starts at zero.
  explicit ElementSums(const elements::Model& model);

  /// Adds the meetings of a run of beams with ellipsoids, of which there are `count`. `met` has the
  /// element of each meeting of the run, and `shares` their shares, by place. Any number of threads
  /// may add at once.
  void add(const EllipsoidColumns& meetings, size_t count, const uint32_t* met,
           const ShareColumns& shares);
  /// Adds the terms of a meeting with a triangle. Any number of threads may add at once.
  void add_triangle(uint32_t element, const TriangleSums& terms);
  /// Adds to the sums of a mesh.
  void add_noise(elements::Kind mesh, const MeshNoise& noise);
  /// Multiplies all sums.
  void multiply(unsigned factor);

  /// The sums of a triangle by its element number.
  TriangleSums triangle(size_t element) const;
  /// The sums of an ellipsoid by its place in the model's vector of ellipsoids.
  EllipsoidSums ellipsoid(size_t index) const;
  /// The sums of a mesh of the model, the ground or the surface.
  NoiseSums noise(elements::Kind mesh) const;

  /// The sums as they are kept, without the meshes' noise: hits, passes, slope and curvature of
  /// each triangle, and the fields of each ellipsoid (`SumField`).
  using TriangleRow = std::array<FixedSum, 4>;
  using EllipsoidRow = std::array<int64_t, kSumRow>;
  std::vector<TriangleRow>& triangle_rows() { return triangles_; }
  std::vector<EllipsoidRow>& ellipsoid_rows() { return ellipsoids_; }
  const std::vector<TriangleRow>& triangle_rows() const { return triangles_; }
  const std::vector<EllipsoidRow>& ellipsoid_rows() const { return ellipsoids_; }

 private:
  std::vector<TriangleRow> triangles_;
  std::vector<EllipsoidRow> ellipsoids_;
  std::vector<uint8_t> locks_;  ///< Locks as those of `SumTable`.
  std::array<MeshNoise, 2> noise_;
};

}  // namespace underbrush::likelihood
