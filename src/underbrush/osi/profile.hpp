/// \file
/// This file has the rays of a sensor as OSI's configuration describes them.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "underbrush/osi/sensor_view.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::osi {

/// A lidar and its rays.
struct Profile {
  sensor::Sensor sensor;
  std::vector<sensor::SubRay> sub_rays;  ///< Sub-rays, the same for every beam.
  LidarConfiguration configuration;      ///< With all directions and timings.
  std::vector<float> weight;             ///< The share of the beam's energy of each sub-ray.
};

/// The rays of one cycle of a sensor that stands still. Each beam has a grid of at most `columns` ×
/// `rows` sub-rays over its cross-section; 0 = as many as the sensor's file suggests, 1 × 1 = a
/// thin ray. `sensor` is a name of the catalogue or a file. Throws as `sensor::load` does.
Profile make_profile(const std::string& sensor, int columns, int rows);

/// The configuration that an environment simulator needs, so that it fires these rays.
SensorViewConfiguration request_of(const Profile& profile, uint64_t sensor_id,
                                   const Mounting& mounting);

/// The unit vectors of the beams: the mean direction of the rays of each. There must be as many
/// rays as a multiple of `rays_per_beam`.
std::vector<Vec3> beam_directions(const LidarConfiguration& configuration, size_t rays_per_beam);

}  // namespace underbrush::osi
