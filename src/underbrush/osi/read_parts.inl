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

/// Reads an identifier into `id`.
inline bool read_one_id(protozero::pbf_reader& r, Place& place, const char* name, uint64_t& id) {
  return read_part(r, place, name, -1,
                   [&](protozero::data_view p, Place& at) { id = read_id(p, at); });
}
inline bool add_id(protozero::pbf_reader& r, Place& place, const char* name,
                   std::vector<uint64_t>& ids) {
  return read_part(r, place, name, int64_t(ids.size()),
                   [&](protozero::data_view p, Place& at) { ids.push_back(read_id(p, at)); });
}

}  // namespace underbrush::osi
