#include "underbrush/elements/light.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::elements {

Gain::Between Gain::between(double x) const {
  const auto above = std::upper_bound(at.begin(), at.end(), x);
  if (above == at.begin()) return {};
  const size_t first = size_t(above - at.begin()) - 1;
  if (above == at.end()) return {first, first, 0};
  return {first, first + 1, (x - at[first]) / (*above - at[first])};
}

double Gain::operator()(double x) const {
  if (at.empty()) return 1;
  const Between b = between(x);
  return (1 - b.weight) * gain[b.first] + b.weight * gain[b.second];
}

void Gain::check() const {
  require(at.size() == gain.size(), "light: knots and gains differ in number");
  for (size_t k = 0; k < at.size(); ++k) {
    require(std::isfinite(at[k]) && (k == 0 || at[k] > at[k - 1]), "light: knots must rise");
    require(std::isfinite(gain[k]) && gain[k] > 0, "light: a gain is not positive");
  }
}

double Light::response(double range_m, double cosine, bool is_ellipsoid, uint32_t ring_number,
                       bool same_sensor) const {
  const double h = same_sensor && ring_number < ring.size() ? ring[ring_number] : 1;
  return range(range_m) * incidence[is_ellipsoid](cosine) * h;
}

void Light::check() const {
  require(std::isfinite(max_intensity) && max_intensity >= 0, "light: a bad largest intensity");
  range.check();
  for (const Gain& g : incidence) g.check();
  for (const double h : ring) require(std::isfinite(h) && h > 0, "light: a gain is not positive");
}

}  // namespace underbrush::elements
