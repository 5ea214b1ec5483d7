#include "underbrush/osi/static_data.hpp"

#include "underbrush/osi/write.hpp"

namespace underbrush::osi {

void StaticData::fill(SensorView& view) {
  SensorView missing;
  if (!view.version && version_) missing.version = view.version = version_;
  if (view.version) version_ = view.version;
  if (!view.truth) return;
  if (!view.host_vehicle_id && !view.truth->host_vehicle_id && host_) {
    missing.host_vehicle_id = view.host_vehicle_id = host_;
  }
  if (view.truth->host_vehicle_id) host_ = view.truth->host_vehicle_id;
  if (view.host_vehicle_id) host_ = view.host_vehicle_id;
  if (!view.bytes.empty()) write(missing, view.bytes);  // A repeated field replaces the first one.
  for (MovingObject& m : view.truth->moving) {
    if (!host_ || m.id != *host_) continue;
    if (m.centre_to_rear_m) centre_to_rear_m_ = m.centre_to_rear_m;
    if (!m.centre_to_rear_m) m.centre_to_rear_m = centre_to_rear_m_;
  }
}

}  // namespace underbrush::osi
