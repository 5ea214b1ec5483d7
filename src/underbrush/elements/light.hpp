/// \file
/// The reflectances of a model's elements, and the intensity response of the sensor.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace underbrush::elements {

/// The reflectance of an element, in the unit of the log's intensities: mean and standard deviation
/// of the intensity of a return whose response is 1. Where nothing is known, both are 0.
struct Reflectance {
  float mean = 0;
  float spread = 0;
};

/// A function that is linear between knots and constant beyond the first and the last.
struct Gain {
  std::vector<double> at;    ///< The places of the knots, in rising order.
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
  /// f(r) g(c) h(n); h counts only with `same_sensor`.
  double response(double range_m, double cosine, bool is_ellipsoid, uint32_t ring_number,
                  bool same_sensor) const;
  /// Throws `std::invalid_argument` where a part is inconsistent.
  void check() const;
};

/// The mean and the standard deviation of the reflectances of many elements.
struct MeanReflectance {
  double mean = 0, spread = 0;
};

}  // namespace underbrush::elements
