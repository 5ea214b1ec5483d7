// Readers of parts that several messages have.
#pragma once
#include "underbrush/osi/sensor_data.hpp"
#include "underbrush/osi/wire.inl"

namespace underbrush::osi {

LidarConfiguration read_lidar_configuration(protozero::data_view bytes, Place& place);
LidarSensorView read_lidar_view(protozero::data_view bytes, Place& place);
/// Fills all but `SensorView::bytes`.
void read_view(protozero::data_view bytes, Place& place, SensorView& view);
LidarDetectionData read_lidar(protozero::data_view bytes, Place& place);
LogicalDetectionData read_logical(protozero::data_view bytes, Place& place);

}  // namespace underbrush::osi
