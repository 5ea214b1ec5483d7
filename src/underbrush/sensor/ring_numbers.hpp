/// \file
/// The numbers that files give the rings of a scan, and the channels of a sensor that they mean.
#pragma once
#include <cstddef>
#include <vector>

#include "underbrush/core/point_scan.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::sensor {

/// The usual distance of neighbouring channels of a sensor, rad: the median.
double channel_spacing(const Sensor& sensor);

/// Whether the numbers of a scan's rings distinguish its rings. They do not if a quarter of the
/// `channels` or fewer have a number, and most returns share theirs with others more than 3° above
/// or below: many programs leave all numbers 0.
bool rings_are_numbered(const PointScan& scan, size_t channels);

/// Whether the numbers of rings are channels of the sensor by the median elevations of rings, which
/// are too low by `fault_rad`: to 0.6 of the usual distance of channels in the median.
bool rings_are_channels(const std::vector<uint16_t>& rings, const std::vector<Vec3f>& points,
                        const Sensor& sensor, double fault_rad);

/// Returns the channel of each point of a scan with these numbers of rings. They are the channels,
/// or count from 1, or from the other end, or both, or in the order of firing (from 0 or 1): what
/// is valid for all numbers and fits the median elevations of rings, which are too low by
/// `fault_rad`. The numbers stay as they are if they fit (`rings_are_channels`), or if nothing
/// else fits to a quarter of that distance.
std::vector<uint16_t> channels_of_rings(const std::vector<uint16_t>& rings,
                                        const std::vector<Vec3f>& points, const Sensor& sensor,
                                        double fault_rad);

}  // namespace underbrush::sensor
