/// \file
/// What the beams of a log say of each element, summed so that neither the order of the beams nor
/// the number of threads changes a bit.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "underbrush/elements/model.hpp"
#include "underbrush/fit/responsibilities.hpp"

namespace underbrush::fit {

/// A sum of doubles in fixed point: exact, so in any order. Resolution 2⁻²⁶; each term is held
/// within ±10⁴, which leaves room for 10⁷ terms of that size.
class FixedSum {
 public:
  /// From any number of threads at once.
  void add(double term);
  double value() const { return double(bits_) * 0x1p-26; }

 private:
  int64_t bits_ = 0;
};

/// Derivatives of the expected log-likelihood of one ellipsoid, of density κ, with its Fisher
/// information, in its own whitened frame: y = L⁻¹ (x − μ), Σ = L Lᵀ. The ellipsoid moves as
/// μ + L s, L (I + E) with E symmetric, κ e^k.
struct EllipsoidSums {
  double hits = 0;    ///< Σ r
  double passes = 0;  ///< Σ of the beams that went through.
  double loss = 0;    ///< Σ r × −log-likelihood of the beam.
  double density_slope = 0, density_curvature = 0;
  Vec3 shift_slope = Vec3::Zero();
  Mat3 shift_curvature = Mat3::Zero();
  Mat3 stretch_slope = Mat3::Zero();
  Mat3 stretch_curvature = Mat3::Zero();  ///< Of each entry of E by itself.
  Mat3 along = Mat3::Zero();  ///< Σ r x² n nᵀ: misfit x = (z − t)/σ along the beams n.
};

/// Of one triangle.
struct TriangleSums {
  double hits = 0, passes = 0;
};

/// Of the range noise of a mesh: derivatives by the logarithms of range_sigma_m and roughness_m.
struct NoiseSums {
  std::array<double, 2> slope{}, curvature{};
};

/// Sums for all elements of a model.
class ElementSums {
 public:
  ElementSums() = default;
  /// Zeros. The model must outlive the sums, and stay as it is while beams are added.
  explicit ElementSums(const elements::Model& model);

  /// Adds one beam: `ray` and `met` as traced in world coordinates, `range_m` its outcome. From any
  /// number of threads at once.
  void add(const Ray& ray, std::span<const trace::Intersection> met, double range_m,
           const Responsibilities& shares);

  TriangleSums triangle(size_t element) const;
  EllipsoidSums ellipsoid(size_t index) const;
  NoiseSums noise(elements::Kind mesh) const;
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
