#include "underbrush/test_site/crown.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace underbrush::test_site {

double Crown::radius_at(double z_m) const {
  const double middle = base_m + widest * (top_m - base_m);
  const double half = z_m > middle ? top_m - middle : middle - base_m;
  const double t = (z_m - middle) / half;
  return radius_m * std::sqrt(std::max(0.0, 1 - t * t));
}

std::vector<Vec3> crown_markers(const Crown& crown, double spacing_m, Stream& random) {
  struct Wave {
    Vec3 k;
    double phase;
  };
  std::array<Wave, 8> waves;
  const double lump = 1.1 * crown.radius_m;
  for (Wave& w : waves) {
    const double z = random.uniform(-1, 1);
    const double azimuth = random.uniform(0, 2 * M_PI);
    const double r = std::sqrt(1 - z * z);
    w.k = 2 * M_PI / (lump * random.uniform(0.7, 1.4)) *
          Vec3(r * std::cos(azimuth), r * std::sin(azimuth), z);
    w.phase = random.uniform(0, 2 * M_PI);
  }
  const auto lumpiness = [&](const Vec3& p) {
    double sum = 0;
    for (const Wave& w : waves) sum += std::cos(w.k.dot(p) + w.phase);
    return sum / std::sqrt(0.5 * double(waves.size()));
  };

  const double height = crown.top_m - crown.base_m;
  const double box = 4 * crown.radius_m * crown.radius_m * height;
  const auto tries = size_t(box / std::pow(spacing_m, 3));
  std::vector<Vec3> markers;
  for (size_t i = 0; i < tries; ++i) {
    Vec3 p;
    p.x() = crown.radius_m * random.uniform(-1, 1);
    p.y() = crown.radius_m * random.uniform(-1, 1);
    p.z() = crown.base_m + height * random.uniform();
    const double edge = p.head<2>().norm() / (crown.radius_at(p.z()) + 1e-9);
    const double shade = edge < crown.bare ? 0.8 : 0;
    if (edge < 1 && lumpiness(p) > -1 + 0.7 * edge * edge + shade) {
      markers.push_back(p);
    }
  }
  return markers;
}

}  // namespace underbrush::test_site
