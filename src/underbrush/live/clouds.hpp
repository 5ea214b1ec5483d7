/// \file
/// The beams of firings as point clouds.
#pragma once
#include <vector>

#include "underbrush/io/driver_layout.hpp"
#include "underbrush/live/live_sensors.hpp"

namespace underbrush::live {

/// Packs the beams of a firing as a driver does, in a cloud for each sensor, in its frame.
std::vector<PointCloud> clouds_of(const LiveSensors& sensors, const Firing& firing, BeamLog beams,
                                  io::DriverLayout layout);

}  // namespace underbrush::live
