// Snell's law by angles, and prisms in the frame of HELIOS++: an independent reference for beams
// that pass rotating prisms.
#pragma once
#include <cmath>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::sensor {

struct Wedge {
  double hz, angle_deg, index;
};

/// Turns a beam in its plane of incidence from the angle of incidence to that of refraction.
inline Vec3 by_snell(const Vec3& beam, const Vec3& normal, double before, double after) {
  const Vec3 axis = beam.cross(-normal);
  if (axis.norm() < 1e-14) return beam;
  const double incident = std::atan2(axis.norm(), beam.dot(-normal));
  const double refracted = std::asin(before / after * std::sin(incident));
  return Eigen::AngleAxisd(incident - refracted, axis.normalized()) * beam;
}

/// The beam after prisms that have turned for `t` seconds; x right, y forward, z up. An inclined
/// face is a disc that leans about x and then turns with its rotor: towards the laser its upper
/// edge, away from it its lower one.
inline Vec3 behind_wedges(const std::vector<Wedge>& wedges, double t, Vec3 beam) {
  for (const Wedge& w : wedges) {
    const Eigen::AngleAxisd turn(2 * M_PI * w.hz * t, Vec3::UnitY());
    const Eigen::AngleAxisd lean(-w.angle_deg * M_PI / 180, Vec3::UnitX());
    const Vec3 flat = -Vec3::UnitY(), inclined = turn * (lean * flat);
    beam = by_snell(beam, w.angle_deg > 0 ? inclined : flat, 1, w.index);
    beam = by_snell(beam, w.angle_deg > 0 ? flat : inclined, w.index, 1);
  }
  return beam;
}

/// The axes of HELIOS++ (x right, y forward) in ours (x forward, y left).
inline Vec3 from_helios(const Vec3& v) { return {v.y(), -v.x(), v.z()}; }

}  // namespace underbrush::sensor
