#include "underbrush/radiometry/normal_quantiles.hpp"

#include <cmath>

#include "underbrush/core/rng.hpp"

namespace underbrush::radiometry {

const std::array<float, 4096>& normal_quantiles() {
  static const std::array<float, 4096> table = [] {
    std::array<double, 4096> exact{};
    double square = 0;
    for (size_t k = 0; k < exact.size(); ++k) {
      exact[k] = normal_from_uniform((double(k) + 0.5) / double(exact.size()));
      square += exact[k] * exact[k] / double(exact.size());
    }
    std::array<float, 4096> t{};
    for (size_t k = 0; k < t.size(); ++k) t[k] = float(exact[k] / std::sqrt(square));
    return t;
  }();
  return table;
}

}  // namespace underbrush::radiometry
