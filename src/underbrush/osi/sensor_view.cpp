#include "underbrush/osi/sensor_view.hpp"

#include <algorithm>

namespace underbrush::osi {

const MovingObject* GroundTruth::find(uint64_t id) const {
  const auto at =
      std::find_if(moving.begin(), moving.end(), [id](const auto& m) { return m.id == id; });
  return at == moving.end() ? nullptr : &*at;
}

const MovingObject* SensorView::host() const {
  if (!truth) return nullptr;
  const auto id = host_vehicle_id ? host_vehicle_id : truth->host_vehicle_id;
  return id ? truth->find(*id) : nullptr;
}

Pose world_from_vehicle(const MovingObject& vehicle) {
  Pose p = vehicle.base.pose();
  if (vehicle.centre_to_rear_m) p.translation = p * *vehicle.centre_to_rear_m;
  return p;
}

}  // namespace underbrush::osi
