#include "underbrush/radiometry/link_budget.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::radiometry {
namespace {
constexpr double kPlanck = 6.62607015e-34, kBoltzmann = 1.380649e-23, kLight = 299792458;
constexpr double kCharge = 1.602176634e-19;
constexpr double kSunTemperature = 5772, kSunSolidAngle = 6.794e-5;
}  // namespace

void LinkBudget::check() const {
  for (const double v : {peak_power_w, aperture_m, transmission, wavelength_m, view_rad, filter_m,
                         responsivity_a_per_w, bandwidth_hz, dark_a_per_rt_hz}) {
    require(std::isfinite(v) && v > 0, "link: all values must be positive");
  }
  require(transmission <= 1, "link: optics that amplify");
}

double received_power_w(const LinkBudget& link, double range_m, double factor, double fill,
                        double extinction_per_m) {
  return link.peak_power_w * fill * factor * link.aperture_m * link.aperture_m /
         (4 * range_m * range_m) * link.transmission * std::exp(-2 * extinction_per_m * range_m);
}

double solar_irradiance(double wavelength_m) {
  const double l5 = std::pow(wavelength_m, 5);
  const double x = kPlanck * kLight / (wavelength_m * kBoltzmann * kSunTemperature);
  return kSunSolidAngle * 2 * kPlanck * kLight * kLight / (l5 * std::expm1(x));
}

double solar_background_w(const LinkBudget& link, double reflectance, double share) {
  const double radiance = share * solar_irradiance(link.wavelength_m) * reflectance / M_PI;
  const double solid_angle = M_PI / 4 * link.view_rad * link.view_rad;
  const double area = M_PI / 4 * link.aperture_m * link.aperture_m;
  return radiance * solid_angle * area * std::sqrt(link.transmission) * link.filter_m;
}

double noise_power_w(const LinkBudget& link, double background_w) {
  const double r = link.responsivity_a_per_w;
  const double square =
      link.dark_a_per_rt_hz * link.dark_a_per_rt_hz + 2 * kCharge * r * background_w;
  return std::sqrt(square * link.bandwidth_hz) / r;
}

double noise_in_light(const LinkBudget& link, double background_w) {
  return noise_power_w(link, background_w) / noise_power_w(link, 0);
}

double signal_at_1m(const LinkBudget& link) {
  link.check();
  return received_power_w(link, 1, 1, 1, 0) / noise_power_w(link, 0);
}

double fog_extinction_per_m(double visibility_m, double wavelength_m) {
  require(visibility_m > 0 && wavelength_m > 0, "fog: visibility and wavelength must be positive");
  const double v = visibility_m / 1000;
  double q = 0;
  if (v > 50) {
    q = 1.6;
  } else if (v > 6) {
    q = 1.3;
  } else if (v > 1) {
    q = 0.16 * v + 0.34;
  } else {
    q = std::max(0.0, v - 0.5);
  }
  return 3.912 / visibility_m * std::pow(wavelength_m / 550e-9, -q);
}

double rain_extinction_per_m(double rate_mm_per_h) {
  require(rate_mm_per_h >= 0, "rain: the rate is negative");
  return 1.076 * std::pow(rate_mm_per_h, 0.67) * M_LN10 / 10 / 1000;
}

}  // namespace underbrush::radiometry
