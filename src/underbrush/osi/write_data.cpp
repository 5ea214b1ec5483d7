#include "underbrush/osi/write.hpp"
#include "underbrush/osi/write_parts.inl"

namespace underbrush::osi {
namespace {

using protozero::pbf_writer;

void write_qualifier(pbf_writer& w, uint32_t tag, DataQualifier value) {
  if (value != DataQualifier::kUnknown) w.add_enum(tag, int32_t(value));
}

void write_wide(pbf_writer& w, uint32_t tag, const std::optional<uint64_t>& value) {
  if (value) w.add_uint64(tag, *value);
}

void write_detection(pbf_writer& w, const LidarDetection& d) {
  pbf_writer part(w, 2);
  part.add_double(1, d.existence);
  write_known_id(part, 2, d.object_id);
  write_part(part, 3, [&](pbf_writer& p) {
    p.add_double(1, d.distance_m);
    p.add_double(2, d.azimuth_rad);
    p.add_double(3, d.elevation_rad);
  });
  part.add_double(7, d.intensity_percent);
  if (d.reflectivity > 0) part.add_double(10, d.reflectivity);
  if (d.pulse_width_m > 0) part.add_double(11, d.pulse_width_m);
  write_number(part, 12, d.radial_velocity_m_s);
  write_known_id(part, 13, d.beam_id);
}

void write_lidar(pbf_writer& w, const LidarDetectionData& l) {
  pbf_writer part(w, 3);
  write_part(part, 1, [&](pbf_writer& h) {
    write_timestamp(h, 1, l.header.measurement_time);
    write_wide(h, 2, l.header.cycle_counter);
    write_mounting(h, 3, l.header.mounting);
    write_qualifier(h, 5, l.header.qualifier);
    write_count(h, 6, l.header.valid_detections);
    write_id(h, 7, l.header.sensor_id);
  });
  for (const LidarDetection& d : l.detections) write_detection(part, d);
}

void write_logical(pbf_writer& w, const LogicalDetectionData& l,
                   const std::optional<Version>& version) {
  write_version(w, 1, version);
  write_part(w, 2, [&](pbf_writer& h) {
    write_timestamp(h, 1, l.time);
    write_qualifier(h, 2, l.qualifier);
    write_count(h, 3, l.valid_detections);
    for (const uint64_t id : l.sensor_ids) write_id(h, 4, id);
  });
  for (const LogicalDetection& d : l.detections) {
    pbf_writer part(w, 3);
    part.add_double(1, d.existence);
    write_known_id(part, 2, d.object_id);
    write_vector(part, 3, d.position_m);
    part.add_double(7, d.intensity_percent);
    write_known_id(part, 10, d.sensor_id);
    if (d.pulse_width_m > 0) part.add_double(12, d.pulse_width_m);
  }
}

void write_object(pbf_writer& w, const DetectedObject& o) {
  pbf_writer part(w, 13);
  write_part(part, 1, [&](pbf_writer& h) {
    write_known_id(h, 1, o.tracking_id);
    for (const uint64_t id : o.ground_truth_ids) write_id(h, 2, id);
    h.add_double(3, o.existence);
    h.add_double(4, o.age_s);
    h.add_enum(5, int32_t(o.measurement_state));
    for (const uint64_t id : o.sensor_ids) write_id(h, 6, id);
  });
  write_base(part, 2, o.base);
  write_base(part, 3, o.base_rmse);
  if (o.reference_point) part.add_enum(4, int32_t(o.reference_point));
  if (o.movement_state) part.add_enum(5, int32_t(o.movement_state));
  for (const Candidate& c : o.candidates) {
    pbf_writer candidate(part, 8);
    candidate.add_double(1, c.probability);
    candidate.add_enum(2, int32_t(c.type));
    if (c.vehicle_type || c.type == uint32_t(ObjectType::kVehicle)) {
      write_required(candidate, 3, [&](pbf_writer& v) { v.add_enum(1, int32_t(c.vehicle_type)); });
    }
    if (c.type == uint32_t(ObjectType::kPedestrian)) {
      for (const uint32_t pose : {4, 5}) candidate.add_message(pose, "", 0);  // Not known.
    }
  }
}

void write_object_header(pbf_writer& w, const ObjectHeader& h) {
  pbf_writer part(w, 12);
  write_timestamp(part, 1, h.measurement_time);
  write_wide(part, 2, h.cycle_counter);
  write_qualifier(part, 3, h.qualifier);
}

void write_free_area(pbf_writer& w, const SensorData& d) {
  pbf_writer part(w, 28);
  for (const auto& polygon : d.free_area) {
    pbf_writer p(part, 1);
    for (const Vec3& vertex : polygon) write_vector(p, 1, vertex);
  }
}

void write_copy(pbf_writer& w, const SensorView& view) {
  if (!view.bytes.empty()) return w.add_message(8, view.bytes);
  write_part(w, 8, [&](pbf_writer& v) { write_view(v, view); });
}

}  // namespace

void write(const SensorData& d, std::string& out) {
  constexpr size_t kDetectionBytes = 90, kLogicalBytes = 75, kRest = 1 << 12;
  size_t expected = out.size() + kRest + d.other.size();
  for (const auto& view : d.views) expected += view->bytes.size();
  for (const auto& l : d.lidar) expected += kDetectionBytes * l.detections.size();
  if (d.logical) expected += kLogicalBytes * d.logical->detections.size();
  out.reserve(expected);
  {
    pbf_writer w(out);
    write_version(w, 1, d.version);
    write_timestamp(w, 2, d.timestamp);
    if (d.host) write_base(w, 3, *d.host);
    write_id(w, 5, d.sensor_id);
    write_mounting(w, 6, d.mounting);
    for (const auto& view : d.views) write_copy(w, *view);
    write_timestamp(w, 9, d.last_measurement_time);
    if (d.object_header) write_object_header(w, *d.object_header);
    for (const DetectedObject& o : d.objects) write_object(w, o);
    if (!d.lidar.empty()) {
      write_part(w, 26, [&](pbf_writer& f) {
        write_version(f, 1, d.version);
        for (const LidarDetectionData& l : d.lidar) write_lidar(f, l);
      });
    }
    if (d.logical)
      write_part(w, 27, [&](pbf_writer& l) { write_logical(l, *d.logical, d.version); });
    if (!d.free_area.empty()) write_free_area(w, d);
  }
  out += d.other;
}

}  // namespace underbrush::osi
