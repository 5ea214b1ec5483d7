#include "underbrush/osi/write.hpp"
#include "underbrush/osi/write_parts.inl"

namespace underbrush::osi {

using protozero::pbf_writer;

void write_version(pbf_writer& w, uint32_t tag, const std::optional<Version>& value) {
  if (!value) return;
  pbf_writer part(w, tag);
  part.add_uint32(1, value->major);
  part.add_uint32(2, value->minor);
  part.add_uint32(3, value->patch);
}

void write_timestamp(pbf_writer& w, uint32_t tag, const std::optional<Timestamp>& value) {
  if (!value) return;
  pbf_writer part(w, tag);
  part.add_int64(1, value->seconds);
  part.add_uint32(2, value->nanos);
}

void write_id(pbf_writer& w, uint32_t tag, const std::optional<uint64_t>& value) {
  if (!value) return;
  pbf_writer part(w, tag);
  part.add_uint64(1, *value);
}

void write_known_id(pbf_writer& w, uint32_t tag, uint64_t id) {
  if (id != kNoId) write_id(w, tag, id);
}

void write_vector(pbf_writer& w, uint32_t tag, const std::optional<Vec3>& value) {
  if (!value) return;
  pbf_writer part(w, tag);
  part.add_double(1, value->x());
  part.add_double(2, value->y());
  part.add_double(3, value->z());
}

void write_number(pbf_writer& w, uint32_t tag, const std::optional<double>& value) {
  if (value) w.add_double(tag, *value);
}

void write_count(pbf_writer& w, uint32_t tag, const std::optional<uint32_t>& value) {
  if (value) w.add_uint32(tag, *value);
}

void write_mounting(pbf_writer& w, uint32_t tag, const std::optional<Mounting>& value) {
  if (!value) return;
  pbf_writer part(w, tag);
  write_vector(part, 1, value->position_m);
  write_vector(part, 2, value->roll_pitch_yaw);
}

void write_base(pbf_writer& w, uint32_t tag, const BaseMoving& base) {
  pbf_writer part(w, tag);
  write_vector(part, 1, base.dimension_m);
  write_vector(part, 2, base.position_m);
  write_vector(part, 3, base.roll_pitch_yaw);
  write_vector(part, 4, base.velocity_m_s);
  write_vector(part, 5, base.acceleration_m_s2);
  write_vector(part, 6, base.turn_rate_rad_s);
}

void write_lidar_configuration(pbf_writer& w, uint32_t tag, const LidarConfiguration& c) {
  pbf_writer part(w, tag);
  write_id(part, 1, c.sensor_id);
  write_mounting(part, 2, c.mounting);
  write_number(part, 4, c.field_horizontal_rad);
  write_number(part, 5, c.field_vertical_rad);
  write_count(part, 6, c.rays_horizontal);
  write_count(part, 7, c.rays_vertical);
  write_count(part, 8, c.most_interactions);
  write_number(part, 9, c.emitter_frequency_hz);
  write_count(part, 10, c.beams);
  for (const Vec3f& d : c.directions) write_vector(part, 11, d.cast<double>());
  for (const uint32_t t : c.timings_us) part.add_uint32(12, t);
}

namespace {

void write_moving(pbf_writer& w, const MovingObject& m) {
  pbf_writer part(w, 5);
  write_known_id(part, 1, m.id);
  write_base(part, 2, m.base);
  part.add_enum(3, int32_t(m.type));
  const bool is_vehicle = m.type == uint32_t(ObjectType::kVehicle);
  if (is_vehicle || m.centre_to_rear_m) {
    write_required(part, 5, [&](pbf_writer& a) { write_vector(a, 4, m.centre_to_rear_m); });
  }
  if (is_vehicle || m.vehicle_type) {
    write_required(part, 6, [&](pbf_writer& v) { v.add_enum(1, int32_t(m.vehicle_type)); });
  }
  if (!m.model_reference.empty()) part.add_string(7, m.model_reference);
  if (m.type == uint32_t(ObjectType::kPedestrian)) part.add_message(12, "", 0);  // Not known.
}

void write_stationary(pbf_writer& w, const StationaryObject& s) {
  pbf_writer part(w, 4);
  write_known_id(part, 1, s.id);
  write_part(part, 2, [&](pbf_writer& b) {
    write_vector(b, 1, s.dimension_m);
    write_vector(b, 2, s.position_m);
    write_vector(b, 3, s.roll_pitch_yaw);
  });
  if (!s.model_reference.empty()) part.add_string(4, s.model_reference);
}

void write_truth(pbf_writer& w, const GroundTruth& t) {
  write_version(w, 1, t.version);
  write_timestamp(w, 2, t.timestamp);
  write_id(w, 3, t.host_vehicle_id);
  for (const StationaryObject& s : t.stationary) write_stationary(w, s);
  for (const MovingObject& m : t.moving) write_moving(w, m);
}

void write_reflection(pbf_writer& w, const Reflection& f) {
  if (f.is_miss()) return w.add_message(2, "", 0);  // A pbf_writer leaves out empty messages.
  pbf_writer part(w, 2);
  part.add_double(1, f.signal_db);
  part.add_double(2, f.time_of_flight_s);
  if (f.has_doppler) part.add_double(3, f.doppler_shift_hz);
  if (f.normal != Vec3f::Zero()) write_vector(part, 5, f.normal.cast<double>());
  write_known_id(part, 6, f.object_id);
}

void write_lidar_view(pbf_writer& w, const LidarSensorView& v) {
  pbf_writer part(w, 1002);
  if (v.configuration) write_lidar_configuration(part, 1, *v.configuration);
  for (const Reflection& f : v.reflections) write_reflection(part, f);
}

}  // namespace

void write_view(pbf_writer& w, const SensorView& v) {
  write_version(w, 1, v.version);
  write_timestamp(w, 2, v.timestamp);
  write_id(w, 3, v.sensor_id);
  write_mounting(w, 4, v.mounting);
  if (v.truth) write_part(w, 7, [&](pbf_writer& t) { write_truth(t, *v.truth); });
  write_id(w, 8, v.host_vehicle_id);
  for (const LidarSensorView& l : v.lidar) write_lidar_view(w, l);
}

void write(const GroundTruth& truth, std::string& out) {
  pbf_writer w(out);
  write_truth(w, truth);
}

void write(const SensorView& view, std::string& out) {
  pbf_writer w(out);
  write_view(w, view);
}

void write_lidar_views(std::span<const LidarSensorView> views, std::string& out) {
  pbf_writer w(out);
  for (const LidarSensorView& v : views) write_lidar_view(w, v);
}

void write(const SensorViewConfiguration& c, std::string& out) {
  pbf_writer w(out);
  write_version(w, 1, c.version);
  write_id(w, 2, c.sensor_id);
  write_mounting(w, 3, c.mounting);
  write_number(w, 5, c.field_horizontal_rad);
  write_number(w, 6, c.field_vertical_rad);
  write_number(w, 7, c.range_m);
  if (c.cycle_s) write_timestamp(w, 8, Timestamp::of(*c.cycle_s));
  for (const LidarConfiguration& l : c.lidar) write_lidar_configuration(w, 1002, l);
}

}  // namespace underbrush::osi
