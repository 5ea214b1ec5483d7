/// \file
/// The reflectances of a model's elements, and the intensity response of the sensor.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::elements {

struct Model;
enum class Kind : uint8_t;

/// The reflectance of an element, in the unit of the log's intensities: mean and standard deviation
/// of the intensity of a return whose response is 1. Where nothing is known, both are 0.
struct Reflectance {
  float mean = 0;
  float spread = 0;
};

/// A function that is linear between knots and constant beyond the first and the last.
struct Gain {
  std::vector<double> at;    ///< Where the knots are, in rising order.
  std::vector<double> gain;  ///< The value at each knot, positive.

  /// The two knots about `x` and the weight of the second.
  struct Between {
    size_t first = 0, second = 0;
    double weight = 0;
  };
  Between between(double x) const;
  double operator()(double x) const;
  /// Throws `std::invalid_argument` where the knots do not rise or a value is not positive.
  void check() const;
};

/// The response of the sensor of a log: a return at the range r (m), under the cosine c of the
/// incidence, from the channel with the number n, has the expected intensity ρ f(r) g(c) h(n),
/// where ρ is the reflectance of its element. Each factor is 1 on average over the log.
struct Light {
  Gain range;                     ///< f.
  std::array<Gain, 2> incidence;  ///< g of triangles, and g of ellipsoids.
  std::vector<double> ring;       ///< h of each channel; 1 for channels not listed.
  /// The largest intensity of the log; simulated intensities do not exceed it.
  double max_intensity = 0;

  /// Whether the light was learnt, from a log with intensities.
  bool known() const { return max_intensity > 0; }
  /// f(r) g(c) h(n); `same_sensor` tells whether h applies.
  double response(double range_m, double cosine, bool is_ellipsoid, uint32_t ring_number,
                  bool same_sensor) const;
  /// Throws `std::invalid_argument` where a part is inconsistent.
  void check() const;
};

/// The cosine of incidence of a ray with the unit vector `direction` (model frame) on an element.
/// For a triangle it is |n·d|. For an ellipsoid with the covariance Σ it is
/// √(dᵀΣ⁻¹d / tr Σ⁻¹), which tends to |n·d| for a flat one and is 1/√3 in every direction for a
/// ball, because a volume has no surface to incline.
double incidence_cosine(const Model& model, size_t element, const Vec3& direction);

/// The reflectance of an element; zeros where the model has no light.
Reflectance reflectance(const Model& model, size_t element);

/// The mean and the standard deviation of the reflectances of many elements.
struct MeanReflectance {
  double mean = 0, spread = 0;
};
/// Computes the mean and the standard deviation of the reflectances of a kind of element, in which
/// an element counts once and as often as it was hit; zeros where there are no elements.
MeanReflectance mean_reflectance(const Model& model, Kind kind);

}  // namespace underbrush::elements
