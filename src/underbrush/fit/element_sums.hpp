/// \file
/// This file sums what the beams of a log say about each element. Sums are exact, so neither the
/// order of the beams nor the number of threads changes a bit.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "underbrush/elements/model.hpp"
#include "underbrush/fit/responsibilities.hpp"

namespace underbrush::fit {

/// A sum of doubles in fixed point, which is exact and so independent of the order of its terms.
/// The resolution is 2⁻²⁶. Terms are clamped to ±10⁴, which leaves room for 10⁷ terms of that size.
class FixedSum {
 public:
  /// Adds a term. Any number of threads may call it at once.
  void add(double term);
  double value() const { return double(bits_) * 0x1p-26; }

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
  double loss = 0;    ///< Σ r × −log-likelihood of the beam, nats.
  double density_slope = 0, density_curvature = 0;  ///< By k.
  Vec3 shift_slope = Vec3::Zero();                  ///< By s.
  Mat3 shift_curvature = Mat3::Zero();              ///< By s.
  Mat3 stretch_slope = Mat3::Zero();                ///< By E.
  /// By E; entry (i, j) belongs to entry (i, j) of E alone.
  Mat3 stretch_curvature = Mat3::Zero();
  /// Σ r x² n nᵀ, with the misfit x = (z − t)/σ and the whitened direction n of a beam.
  Mat3 along = Mat3::Zero();
};

/// The soft hits and passes of one triangle.
struct TriangleSums {
  double hits = 0, passes = 0;
};

/// Derivatives of the expected log-likelihood by the logarithms of a mesh's range_sigma_m and
/// roughness_m, in this order, with their Fisher information.
struct NoiseSums {
  std::array<double, 2> slope{}, curvature{};
};

/// The sums of all elements of a model.
class ElementSums {
 public:
  ElementSums() = default;
  /// Starts at zero. The model must outlive the sums and must not change while beams are added.
  explicit ElementSums(const elements::Model& model);

  /// Adds one beam. `ray` and `met` are as traced in world coordinates, `range_m` is the beam's
  /// outcome (m, or kMiss), and `shares` are those of `find_responsibilities`. Any number of
  /// threads may call it at once.
  void add(const Ray& ray, std::span<const trace::Intersection> met, double range_m,
           const Responsibilities& shares);

  /// The sums of a triangle by its element number.
  TriangleSums triangle(size_t element) const;
  /// The sums of an ellipsoid by its place in the model's vector of ellipsoids.
  EllipsoidSums ellipsoid(size_t index) const;
  /// The sums of a mesh of the model, the ground or the surface.
  NoiseSums noise(elements::Kind mesh) const;
  /// The memory in use, bytes.
  size_t bytes() const;

 private:
  static constexpr size_t kFields = 32;
  struct Frame {
    Vec3 mean;
    Mat3 whiten;  // L⁻¹
  };
  void add_ellipsoid(const Ray& ray, const trace::Intersection& met, double range_m, double hit,
                     double pass, double loss);

  const elements::Model* model_ = nullptr;
  std::vector<Frame> frames_;
  std::vector<std::array<FixedSum, 2>> triangles_;
  std::vector<std::array<FixedSum, kFields>> ellipsoids_;
  std::array<std::array<FixedSum, 4>, 2> noise_;
};

}  // namespace underbrush::fit
