#include "underbrush/osi/trace_contents.hpp"

#include <algorithm>

#include "underbrush/osi/read.hpp"

namespace underbrush::osi {

void TraceContents::add(const std::optional<Version>& v, const std::optional<Timestamp>& t) {
  ++messages;
  versions.insert(v ? std::to_string(v->major) + "." + std::to_string(v->minor) + "." +
                          std::to_string(v->patch)
                    : "none");
  if (!t) return;
  if (!first_s) first_s = t->s();
  if (last_s && t->s() <= *last_s) ++stands;
  last_s = t->s();
}

void TraceContents::add(const GroundTruth& t) {
  if (t.host_vehicle_id) host = t.host_vehicle_id;
  most_moving = std::max(most_moving, t.moving.size());
  stationary = std::max(stationary, t.stationary.size());
  lanes = std::max<size_t>(lanes, t.lanes);
  for (const MovingObject& m : t.moving) moving.insert(m.id);
}

void TraceContents::add(const SensorView& v) {
  if (v.truth) add(*v.truth);
  if (v.host_vehicle_id) host = v.host_vehicle_id;
  lidars = std::max(lidars, v.lidar.size());
  for (const LidarSensorView& l : v.lidar) {
    reflections += l.reflections.size();
    returns += size_t(std::count_if(l.reflections.begin(), l.reflections.end(),
                                    [](const Reflection& f) { return !f.is_miss(); }));
  }
}

void TraceContents::add(const SensorData& d) {
  for (const auto& view : d.views) add(*view);
  for (const LidarDetectionData& l : d.lidar) detections += l.detections.size();
  lidars = std::max(lidars, d.lidar.size());
  if (d.logical) logical += d.logical->detections.size();
  objects += d.objects.size();
  for (const DetectedObject& o : d.objects) tracks.insert(o.tracking_id);
  listed += d.object_header.has_value();
}

TraceContents contents_of(TraceReader& reader) {
  TraceContents c;
  for (std::string message; reader.next(message);) {
    c.bytes += message.size();
    if (reader.type() == MessageType::kGroundTruth) {
      const GroundTruth t = read_ground_truth(message, reader.place());
      c.add(t.version, t.timestamp);
      c.add(t);
    } else if (reader.type() == MessageType::kSensorView) {
      const SensorView v = read_sensor_view(message, reader.place());
      c.add(v.version, v.timestamp);
      c.add(v);
    } else {
      const SensorData d = read_sensor_data(message, reader.place());
      c.add(d.version, d.timestamp);
      c.add(d);
    }
  }
  return c;
}

}  // namespace underbrush::osi
