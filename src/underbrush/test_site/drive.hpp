/// \file
/// The drive of a vehicle along the track of the site.
#pragma once
#include "underbrush/test_site/terrain.hpp"

namespace underbrush::test_site {

/// Parameters of `drive`.
struct DriveParameters {
  double sensor_height_m = 1.9;  ///< m; height above the plane of the wheels' contact points, over
                                 ///< the vehicle's middle.
  double speed_m_s = 3.5;        ///< m/s; mean speed, which varies by ±35 % over 7 s.
  double poses_per_s = 20;
  double wheelbase_m = 2.4;
  double track_width_m = 1.5;
  double margin_m = 4;  ///< m; the drive begins and ends this far inside the site.
};

/// Returns the poses of the sensor (x forward, y left, z up) from one end of the track to the
/// other, beginning at t = 0 s. Pitch, roll and height follow the ground under the four wheels.
/// Throws `std::invalid_argument` for speeds, rates and sizes that are not positive, or a site
/// shorter than its margins.
Trajectory drive(const Terrain& terrain, const DriveParameters& parameters);

}  // namespace underbrush::test_site
