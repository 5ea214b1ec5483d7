#include "underbrush/sensor/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "underbrush/core/check.hpp"

namespace underbrush::sensor {

double Sensor::azimuth_step_rad() const { return 2 * M_PI * rate_hz * firing_period_s; }

std::vector<uint16_t> Sensor::firing_order() const {
  std::vector<uint16_t> order(channels.size());
  std::iota(order.begin(), order.end(), uint16_t(0));
  std::stable_sort(order.begin(), order.end(), [this](uint16_t a, uint16_t b) {
    return channels[a].time_s < channels[b].time_s;
  });
  return order;
}

void Sensor::check() const {
  const auto positive = [](double v) { return std::isfinite(v) && v > 0; };
  const auto not_negative = [](double v) { return std::isfinite(v) && v >= 0; };
  require(!channels.empty() && channels.size() <= UINT16_MAX, "sensor: no channels, or too many");
  require(positive(rate_hz) && positive(firing_period_s),
          "sensor: rate and period must be positive");
  require(firings_per_revolution() >= 1, "sensor: a firing lasts longer than a revolution");
  require(std::isfinite(start_azimuth_rad), "sensor: start azimuth is not finite");
  require(firings_per_packet > 0, "sensor: firings per packet must be positive");
  require(not_negative(min_range_m) && positive(max_range_m) && min_range_m < max_range_m,
          "sensor: needs 0 <= minimum range < maximum range");
  require(
      not_negative(range_sigma_m) && not_negative(range_resolution_m) && not_negative(wavelength_m),
      "sensor: a negative size");
  beam.check();
  for (const Channel& c : channels) {
    require(std::abs(c.elevation_rad) <= M_PI / 2, "sensor: elevation beyond 90 degrees");
    require(std::isfinite(c.azimuth_rad) && std::isfinite(c.z_m), "sensor: channel is not finite");
    require(c.time_s >= 0 && c.time_s < firing_period_s,
            "sensor: channel fires outside the firing period");
  }
}

}  // namespace underbrush::sensor
