#include "underbrush/sensor/ring_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "underbrush/sensor/angles.hpp"
#include "underbrush/sensor/rays.hpp"

namespace underbrush::sensor {
namespace {

constexpr double kNear = 0.6;  // of the usual distance of channels

using NumberMap =
    std::vector<uint16_t>;  // The channel of each number from 0 to the number of channels.

/// The returns of a ring.
struct NumberedRing {
  uint16_t number;
  double elevation_rad, per_metre;  // Medians; per_metre is 1 / range.
};

std::vector<NumberedRing> measured_rings(const std::vector<uint16_t>& numbers,
                                         const std::vector<Vec3f>& points, double fault_rad) {
  std::map<uint16_t, std::pair<std::vector<double>, std::vector<double>>> values;
  for (size_t i = 0; i < points.size(); ++i) {
    if (kind_of(points[i], 0) != PointKind::kReturn) continue;
    auto& [elevation, per_metre] = values[numbers[i]];
    elevation.push_back(elevation_of(points[i]) + fault_rad);
    per_metre.push_back(1 / points[i].cast<double>().norm());
  }
  std::vector<NumberedRing> out;
  out.reserve(values.size());
  for (auto& [number, of] : values) out.push_back({number, median(of.first), median(of.second)});
  return out;
}

/// The median distance of rings from their channels, rad; infinite where a ring has none.
double misfit(const std::vector<NumberedRing>& rings, const NumberMap& map, const Sensor& sensor) {
  std::vector<double> faults;
  for (const NumberedRing& ring : rings) {
    if (ring.number >= map.size() || map[ring.number] >= sensor.channels.size()) return INFINITY;
    const Channel& c = sensor.channels[map[ring.number]];
    const double parallax =
        std::asin(std::clamp(c.z_m * std::cos(c.elevation_rad) * ring.per_metre, -1.0, 1.0));
    faults.push_back(std::abs(ring.elevation_rad - c.elevation_rad - parallax));
  }
  return median(faults);
}

/// The ways to number rings, the first being that of the sensor.
std::vector<NumberMap> maps_of(const Sensor& sensor) {
  const size_t n = sensor.channels.size();
  NumberMap own(n + 1), reversed(n + 1, UINT16_MAX), fired = sensor.firing_order();
  for (size_t r = 0; r <= n; ++r) own[r] = uint16_t(r);
  for (size_t r = 0; r < n; ++r) reversed[r] = uint16_t(n - 1 - r);
  fired.push_back(UINT16_MAX);
  std::vector<NumberMap> out{own, own, reversed, reversed, fired, fired};
  for (size_t k = 1; k < out.size(); k += 2)
    std::rotate(out[k].begin(), out[k].end() - 1, out[k].end());
  for (size_t k = 1; k < out.size(); k += 2) out[k][0] = UINT16_MAX;
  return out;
}

}  // namespace

double channel_spacing(const Sensor& sensor) {
  std::vector<double> elevation, gaps;
  for (const Channel& c : sensor.channels) elevation.push_back(c.elevation_rad);
  std::sort(elevation.begin(), elevation.end());
  for (size_t k = 1; k < elevation.size(); ++k) gaps.push_back(elevation[k] - elevation[k - 1]);
  return median(gaps);
}

bool rings_are_numbered(const PointScan& scan, size_t channels) {
  constexpr double kWide = 3 * M_PI / 180;
  std::map<uint16_t, std::vector<double>> elevation;
  for (size_t i = 0; i < scan.size(); ++i) {
    if (kind_of(scan.point[i], 0) != PointKind::kReturn) continue;
    elevation[scan.ring[i]].push_back(elevation_of(scan.point[i]));
    if (4 * elevation.size() > std::max<size_t>(channels, 4)) return true;
  }
  size_t returns = 0, wide = 0;
  for (auto& [number, e] : elevation) {
    std::sort(e.begin(), e.end());
    returns += e.size();
    if (e[e.size() * 9 / 10] - e[e.size() / 10] > kWide) wide += e.size();
  }
  return 2 * wide <= returns;
}

bool rings_are_channels(const std::vector<uint16_t>& rings, const std::vector<Vec3f>& points,
                        const Sensor& sensor, double fault_rad) {
  const std::vector<NumberedRing> measured = measured_rings(rings, points, fault_rad);
  return misfit(measured, maps_of(sensor)[0], sensor) <= kNear * channel_spacing(sensor);
}

std::vector<uint16_t> channels_of_rings(const std::vector<uint16_t>& rings,
                                        const std::vector<Vec3f>& points, const Sensor& sensor,
                                        double fault_rad) {
  const std::vector<NumberedRing> measured = measured_rings(rings, points, fault_rad);
  if (measured.empty() || sensor.channels.size() < 2) return rings;
  const double spacing = channel_spacing(sensor);
  const std::vector<NumberMap> maps = maps_of(sensor);
  const double as_they_are = misfit(measured, maps[0], sensor);
  if (as_they_are <= kNear * spacing) return rings;
  double least = std::isfinite(as_they_are) ? 0.25 * spacing : INFINITY;
  const NumberMap* best = nullptr;
  for (const NumberMap& map : maps) {
    const double fault = misfit(measured, map, sensor);
    if (!(fault < least)) continue;
    least = fault;
    best = &map;
  }
  if (!best) return rings;
  std::vector<uint16_t> out(rings.size());
  for (size_t i = 0; i < rings.size(); ++i) {
    // The ring of a point that is no return may be any number.
    out[i] = rings[i] < best->size() && (*best)[rings[i]] != UINT16_MAX ? (*best)[rings[i]] : 0;
  }
  return out;
}

}  // namespace underbrush::sensor
