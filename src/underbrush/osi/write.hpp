/// \file
/// This file encodes OSI's messages, as protobuf's own encoder would: fields in ascending order.
#pragma once
#include <span>
#include <string>

#include "underbrush/osi/sensor_data.hpp"

namespace underbrush::osi {

/// Appends an encoded GroundTruth to `out`.
void write(const GroundTruth& truth, std::string& out);
/// Appends an encoded SensorView, from its values and not from `SensorView::bytes`.
void write(const SensorView& view, std::string& out);
/// Appends an encoded SensorData. A view that was read is passed on as it was read.
void write(const SensorData& data, std::string& out);
/// Appends an encoded SensorViewConfiguration.
void write(const SensorViewConfiguration& configuration, std::string& out);
/// Appends lidar views to an encoded SensorView.
void write_lidar_views(std::span<const LidarSensorView> views, std::string& out);

}  // namespace underbrush::osi
