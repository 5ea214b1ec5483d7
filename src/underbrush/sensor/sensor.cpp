#include "underbrush/sensor/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "underbrush/core/check.hpp"

namespace underbrush::sensor {

double Sensor::azimuth_step_rad() const { return 2 * M_PI * rate_hz * firing_period_s; }

size_t Sensor::rings() const {
  if (kind == Kind::kRaster) return size_t(raster.rows);
  return std::max<size_t>(1, kind == Kind::kRisley ? risley.lasers.size() : channels.size());
}

double Sensor::beams_per_s() const {
  if (kind == Kind::kSpinning) return double(channels.size()) / firing_period_s;
  if (kind == Kind::kRisley) return risley.pulse_hz * double(risley.lasers.size());
  return double(shots_per_cycle()) / shot_cycle_s();
}

size_t Sensor::beams_per_packet() const {
  return size_t(firings_per_packet) * (kind == Kind::kSpinning ? channels.size() : 1);
}

double Sensor::shot_cycle_s() const { return kind == Kind::kSequence ? cycle_s : 1 / rate_hz; }

uint64_t Sensor::shots_per_cycle() const {
  if (kind == Kind::kRisley) return shots_before(shot_cycle_s());
  return kind == Kind::kRaster ? raster.size() : shots.size();
}

Shot Sensor::shot(uint64_t k) const {
  if (kind == Kind::kRisley) return risley.shot(k);
  const uint64_t cycle = k / shots_per_cycle(), within = k % shots_per_cycle();
  Shot s = kind == Kind::kSequence ? shots[within] : raster.shot(within);
  if (kind == Kind::kRaster) s.time_s = double(within) * firing_period_s;
  s.time_s += double(cycle) * shot_cycle_s();
  return s;
}

uint64_t Sensor::shots_before(double time_s) const {
  const double slack = 1e-6 * firing_period_s;
  if (time_s <= slack) return 0;
  if (kind == Kind::kRisley) {
    return uint64_t(std::ceil((time_s - slack) * risley.pulse_hz)) * risley.lasers.size();
  }
  const auto cycle = uint64_t((time_s - slack) / shot_cycle_s());
  const double within = time_s - double(cycle) * shot_cycle_s() - slack;
  uint64_t low = 0, high = shots_per_cycle();
  while (low < high) {
    const uint64_t middle = (low + high) / 2;
    if (shot(middle).time_s < within) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return cycle * shots_per_cycle() + low;
}

std::vector<uint16_t> Sensor::firing_order() const {
  std::vector<uint16_t> order(channels.size());
  std::iota(order.begin(), order.end(), uint16_t(0));
  std::stable_sort(order.begin(), order.end(), [this](uint16_t a, uint16_t b) {
    return channels[a].time_s < channels[b].time_s;
  });
  return order;
}

void SignalChain::check() const {
  // Detection is in float, in which a positive number may become 0 or infinity.
  const auto positive = [](double v) { return v >= 1e-9 && v <= 1e9; };
  const auto not_negative = [](double v) { return v >= 0 && v <= 1e9; };
  const auto is_pulse_time = [](double s) { return s >= 1e-12 && s <= 1e-5; };
  require(is_pulse_time(pulse_fwhm_s) && is_pulse_time(sample_s) &&
              (receiver_fwhm_s == 0 || is_pulse_time(receiver_fwhm_s)),
          "sensor: pulse, response and sample times must be 0.001 to 10000 ns");
  require(std::hypot(pulse_fwhm_s, receiver_fwhm_s) < kMostSamplesOfPulse * sample_s,
          "sensor: the pulse is longer than 500 samples");
  require(positive(threshold_snr) && positive(saturation_snr) && threshold_snr < saturation_snr,
          "sensor: needs 1e-9 <= threshold < saturation <= 1e9");
  require(not_negative(detection_range_m) && positive(detection_reflectance),
          "sensor: detection range or reflectance is not positive, or huge");
  require(not_negative(min_gap_m) && not_negative(width_resolution_m),
          "sensor: a negative or huge length");
  require(not_negative(adc_step_snr), "sensor: a negative or huge step of the converter");
  require(max_echoes >= 1 && max_echoes <= 16, "sensor: 1 to 16 echoes");
  require(
      positive(intensity_scale) && not_negative(intensity_resolution) && positive(intensity_most),
      "sensor: intensity scale, resolution or maximum");
}

namespace {

/// Refuses sizes that are those of another unit: no lidar has them.
void check_units(const Sensor& s) {
  constexpr double kFarthest = 1e5, kCoarsest = 5, kFastest = 300;  // m, m, Hz
  constexpr double kShortest = 100e-9, kLongest = 20e-6;            // m
  require(s.max_range_m <= kFarthest, "sensor: a maximum range beyond 100 km: is it in mm?");
  require(s.range_sigma_m <= kCoarsest && s.range_resolution_m <= kCoarsest,
          "sensor: a range noise or resolution of more than 5 m: is it in mm?");
  require(s.kind != Kind::kSpinning || s.rate_hz <= kFastest,
          "sensor: a rate of more than 300 Hz: is it in revolutions a minute?");
  require(s.wavelength_m == 0 || (s.wavelength_m >= kShortest && s.wavelength_m <= kLongest),
          "sensor: a wavelength beyond 100 nm to 20 µm");
  constexpr size_t kMany = 8;
  double highest = 0;
  for (const Channel& c : s.channels) highest = std::max(highest, std::abs(c.elevation_rad));
  require(s.channels.size() < kMany || highest == 0 || highest > M_PI / 2 * M_PI / 180,
          "sensor: all elevations are within 1.57 degrees: are they in radians?");
}

}  // namespace

void Sensor::check() const {
  const auto positive = [](double v) { return std::isfinite(v) && v > 0; };
  const auto not_negative = [](double v) { return std::isfinite(v) && v >= 0; };
  require(positive(rate_hz) && positive(firing_period_s),
          "sensor: rate and period must be positive");
  require(firings_per_packet > 0, "sensor: firings per packet must be positive");
  require(
      kind != Kind::kSequence || shots.empty() || rate_hz * cycle_s <= 1000 * double(shots.size()),
      "sensor: many more frames than shots");
  require(not_negative(min_range_m) && positive(max_range_m) && min_range_m < max_range_m,
          "sensor: needs 0 <= minimum range < maximum range");
  require(
      not_negative(range_sigma_m) && not_negative(range_resolution_m) && not_negative(wavelength_m),
      "sensor: a negative size");
  require(sub_rays[0] >= 1 && sub_rays[1] >= 1, "sensor: needs at least one sub-ray");
  beam.check();
  signal.check();
  check_units(*this);
  for (const Channel& c : channels) {
    require(std::abs(c.elevation_rad) <= M_PI / 2, "sensor: elevation beyond 90 degrees");
    require(std::isfinite(c.azimuth_rad) && std::isfinite(c.z_m), "sensor: channel is not finite");
    require(c.time_s >= 0 && c.time_s < firing_period_s,
            "sensor: channel fires outside the firing period");
  }
  if (kind == Kind::kSpinning) {
    require(!channels.empty() && channels.size() <= UINT16_MAX, "sensor: no channels, or too many");
    require(firings_per_revolution() >= 1, "sensor: a firing lasts longer than a revolution");
    require(std::isfinite(start_azimuth_rad), "sensor: start azimuth is not finite");
    return;
  }
  if (kind == Kind::kRisley) {
    risley.check();
    require(rate_hz <= 1000 * beams_per_s(), "sensor: many more frames than shots");
    return;
  }
  require(positive(shot_cycle_s()) && shots_per_cycle() > 0, "sensor: no shots");
  if (kind == Kind::kRaster) {
    require(raster.rows <= UINT16_MAX, "sensor: too many rows");
    for (const uint64_t k : {uint64_t(0), raster.size() - 1}) {
      const Shot s = raster.shot(k);
      require(std::abs(s.elevation_rad) <= M_PI / 2 && std::isfinite(s.azimuth_rad),
              "sensor: raster beyond 90 degrees");
    }
    return;
  }
  double before = 0;
  for (const Shot& s : shots) {
    require(std::isfinite(s.azimuth_rad) && std::abs(s.elevation_rad) <= M_PI / 2,
            "sensor: a shot beyond 90 degrees");
    require(s.time_s >= before && s.time_s < cycle_s, "sensor: shots are not in order of time");
    before = s.time_s;
  }
}

std::string_view kind_name(const Sensor& sensor) {
  if (sensor.kind == Kind::kSpinning) return "spinning";
  if (sensor.kind == Kind::kRaster) return "raster";
  if (sensor.kind == Kind::kRisley) return "risley";
  return sensor.channels.empty() ? "directions" : "sweep";
}

}  // namespace underbrush::sensor
