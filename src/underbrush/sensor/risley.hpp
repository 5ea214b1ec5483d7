/// \file
/// This file has the beams of scanners that deflect lasers with rotating prisms (Risley prisms).
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/sensor/shots.hpp"

namespace underbrush::sensor {

/// A prism that rotates about the x axis of its laser. One of its faces is perpendicular to that
/// axis.
struct Prism {
  double rotor_hz = 0;   ///< Revolutions per second, clockwise in the view along x.
  double angle_rad = 0;  ///< Angle between the faces; positive where the laser's side is inclined.
  double index = 1;      ///< Refractive index, relative to the air's.
};

/// A laser with the prisms that its beam passes, in this order. At time 0 all of them are turned so
/// that they deflect the beam downwards.
struct PrismLaser {
  Vec3 direction = Vec3::UnitX();  ///< Unit vector of the beam before the prisms.
  /// Turns laser and prisms into the frame of the sensor.
  Eigen::Quaterniond sensor_from_laser = Eigen::Quaterniond::Identity();
  std::vector<Prism> prisms;
};

/// Lasers that fire together at a constant rate.
struct Risley {
  double pulse_hz = 0;  ///< Shots per second of each laser.
  double start_s = 0;   ///< Time for which the prisms have turned at the first shot.
  std::vector<PrismLaser> lasers;

  /// Shot `k`; its ring is the laser. Each face refracts the beam d as [li17] has it: with the
  /// normal n against the beam and the ratio μ of the indices before and after the face,
  /// μ d + (μ c − √(1 − μ² (1 − c²))) n, where c = −d · n.
  Shot shot(uint64_t k) const;
  /// Throws `std::invalid_argument` where a value is out of its range or a prism reflects a beam
  /// totally.
  void check() const;
};

}  // namespace underbrush::sensor
