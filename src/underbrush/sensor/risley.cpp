#include "underbrush/sensor/risley.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::sensor {
namespace {

/// Refracts a beam at a face; `ratio` is that of the indices before and after it. Returns false
/// where the face reflects the beam totally; the beam then leaves along the face.
bool refract(const Vec3& normal, double ratio, Vec3& beam) {
  const double c = -beam.dot(normal);
  const double left = 1 - ratio * ratio * (1 - c * c);
  beam = (ratio * beam + (ratio * c - std::sqrt(std::max(0.0, left))) * normal).normalized();
  return left >= 0;
}

bool pass(const Prism& prism, double turn_rad, Vec3& beam) {
  const Vec3 upright = -Vec3::UnitX();
  const double across = std::sin(prism.angle_rad);
  const Vec3 inclined(-std::cos(prism.angle_rad), -across * std::sin(turn_rad),
                      across * std::cos(turn_rad));
  const double ratio = 1 / prism.index;
  const bool enters = refract(prism.angle_rad > 0 ? inclined : upright, ratio, beam);
  return refract(prism.angle_rad > 0 ? upright : inclined, 1 / ratio, beam) && enters;
}

/// Tells whether the beam passes the prisms from `first` on at steps of all their turns, the
/// finest ones of the first prism, where a beam aslant is totally reflected at a few positions.
bool passes(const PrismLaser& laser, const Vec3& before, size_t first = 0) {
  const int steps = first == 0 ? 720 : 12;
  if (first == laser.prisms.size()) return true;
  for (int k = 0; k < steps; ++k) {
    Vec3 beam = before;
    if (!pass(laser.prisms[first], 2 * M_PI * k / steps, beam)) return false;
    if (!passes(laser, beam, first + 1)) return false;
  }
  return true;
}

}  // namespace

Shot Risley::shot(uint64_t k) const {
  const auto ring = uint16_t(k % lasers.size());
  const PrismLaser& laser = lasers[ring];
  const double time_s = double(k / lasers.size()) / pulse_hz;
  Vec3 beam = laser.direction;
  for (const Prism& prism : laser.prisms) {
    const double turns = prism.rotor_hz * (start_s + time_s);
    pass(prism, 2 * M_PI * (turns - std::floor(turns)), beam);
  }
  beam = laser.sensor_from_laser * beam;
  return {std::atan2(beam.y(), beam.x()), std::atan2(beam.z(), std::hypot(beam.x(), beam.y())),
          time_s, ring};
}

void Risley::check() const {
  require(pulse_hz >= 1e-3 && pulse_hz <= 1e9, "sensor: 0.001 to 1e9 shots a second");
  require(start_s >= 0 && start_s <= 1e9, "sensor: prisms turn from 0 to 1e9 s before they start");
  require(!lasers.empty() && lasers.size() < UINT16_MAX, "sensor: no lasers, or too many");
  for (const PrismLaser& laser : lasers) {
    require(std::abs(laser.direction.norm() - 1) < 1e-6, "sensor: a laser's direction");
    require(std::abs(laser.sensor_from_laser.norm() - 1) < 1e-6, "sensor: a laser's attitude");
    require(laser.prisms.size() <= 3, "sensor: more than 3 prisms");
    for (const Prism& prism : laser.prisms) {
      require(std::abs(prism.angle_rad) < M_PI / 2, "sensor: a prism's angle is below 90 degrees");
      require(prism.index >= 0.1 && prism.index <= 10, "sensor: a refractive index is 0.1 to 10");
      require(std::abs(prism.rotor_hz) <= 1e6, "sensor: a rotor turns at most 1e6 times a second");
    }
    require(passes(laser, laser.direction), "sensor: a prism reflects a beam totally");
  }
}

}  // namespace underbrush::sensor
