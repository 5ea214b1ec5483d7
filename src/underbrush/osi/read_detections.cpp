#include "underbrush/osi/read_parts.inl"

namespace underbrush::osi {
namespace {

using protozero::data_view;
using protozero::pbf_reader;

void read_spherical(data_view bytes, Place& place, LidarDetection& d) {
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case f64(1):
        return finite(r, place, "distance", d.distance_m);
      case f64(2):
        return finite(r, place, "azimuth", d.azimuth_rad);
      case f64(3):
        return finite(r, place, "elevation", d.elevation_rad);
      default:
        return false;
    }
  });
}

LidarDetection read_detection(data_view bytes, Place& place) {
  LidarDetection d;
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case f64(1):
        return finite(r, place, "existence_probability", d.existence);
      case len(2):
        return into(r, place, "object_id", d.object_id, read_id);
      case len(3):
        return read_part(r, place, "position", -1,
                         [&](data_view p, Place& at) { read_spherical(p, at, d); });
      case f64(7):
        return finite(r, place, "intensity", d.intensity_percent);
      case f64(10):
        return finite(r, place, "reflectivity", d.reflectivity);
      case f64(11):
        return finite(r, place, "echo_pulse_width", d.pulse_width_m);
      case f64(12):
        return finite(r, place, "radial_velocity", d.radial_velocity_m_s);
      case len(13):
        return into(r, place, "beam_id", d.beam_id, read_id);
      default:
        return false;
    }
  });
  return d;
}

DetectionHeader read_detection_header(data_view bytes, Place& place) {
  DetectionHeader h;
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case len(1):
        return into(r, place, "timestamp", h.measurement_time, read_timestamp);
      case var(2):
        return number(r, h.cycle_counter);
      case len(3):
        return into(r, place, "mounting_position", h.mounting, read_mounting);
      case var(5):
        return number(r, h.qualifier);
      case var(6):
        return number(r, h.valid_detections);
      case len(7):
        return into(r, place, "sensor_id", h.sensor_id, read_id);
      default:
        return false;
    }
  });
  return h;
}

}  // namespace

LidarDetectionData read_lidar(data_view bytes, Place& place) {
  LidarDetectionData l;
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case len(1):
        return into(r, place, "header", l.header, read_detection_header);
      case len(2):
        return add_part(r, place, "detection", l.detections, read_detection);
      default:
        return false;
    }
  });
  return l;
}

namespace {

LogicalDetection read_logical_detection(data_view bytes, Place& place) {
  LogicalDetection d;
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case f64(1):
        return finite(r, place, "existence_probability", d.existence);
      case len(2):
        return into(r, place, "object_id", d.object_id, read_id);
      case len(3):
        return read_part(r, place, "position", -1, [&](data_view p, Place& at) {
          d.position_m = read_vector(p, at, d.position_m);
        });
      case f64(7):
        return finite(r, place, "intensity", d.intensity_percent);
      case len(10):
        return into(r, place, "sensor_id", d.sensor_id, read_id);
      case f64(12):
        return finite(r, place, "echo_pulse_width", d.pulse_width_m);
      default:
        return false;
    }
  });
  return d;
}

}  // namespace

LogicalDetectionData read_logical(data_view bytes, Place& place) {
  LogicalDetectionData l;
  const auto read_header = [&](data_view part, Place& at) {
    read_fields(part, at, [&](pbf_reader& r, uint32_t key) {
      switch (key) {
        case len(1):
          return into(r, at, "timestamp", l.time, read_timestamp);
        case var(2):
          return number(r, l.qualifier);
        case var(3):
          return number(r, l.valid_detections);
        case len(4):
          return add_part(r, at, "sensor_id", l.sensor_ids, read_id);
        default:
          return false;
      }
    });
  };
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case len(2):
        return read_part(r, place, "header", -1, read_header);
      case len(3):
        return add_part(r, place, "logical_detection", l.detections, read_logical_detection);
      default:
        return false;
    }
  });
  return l;
}

}  // namespace underbrush::osi
