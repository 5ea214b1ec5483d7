#include "underbrush/osi/sensor_data.hpp"

namespace underbrush::osi {

Pose world_from_virtual(const SensorData& data) {
  const Pose vehicle = data.host ? data.host->pose() : Pose{};
  return data.mounting ? vehicle * data.mounting->pose() : vehicle;
}

}  // namespace underbrush::osi
