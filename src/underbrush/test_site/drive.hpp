/// \file
/// The drive of a vehicle along the track.
#pragma once
#include "underbrush/test_site/terrain.hpp"

namespace underbrush::test_site {

/// How the vehicle drives.
struct DriveParameters {
  double sensor_height_m = 1.9;  ///< Above the wheels' contact plane, over the vehicle's middle.
  double speed_m_s = 3.5;        ///< Mean; it sways by ±35 % over 7 s.
  double poses_per_s = 20;
  double wheelbase_m = 2.4;
  double track_width_m = 1.5;
  double margin_m = 4;  ///< The drive begins and ends this far inside the site.
};

/// Poses of the sensor (x forward, y left, z up) from one end of the track to the other, from t =
/// 0; pitch, roll and height follow the ground under the four wheels. Throws
/// `std::invalid_argument`.
Trajectory drive(const Terrain& terrain, const DriveParameters& parameters);

}  // namespace underbrush::test_site
