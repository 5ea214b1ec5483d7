#include "underbrush/osi/read.hpp"
#include "underbrush/osi/read_parts.inl"
#include "underbrush/osi/trace.hpp"

namespace underbrush::osi {
namespace {

using protozero::data_view;
using protozero::pbf_reader;

void read_item_header(data_view bytes, Place& place, DetectedObject& o) {
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case len(1):
        return into(r, place, "tracking_id", o.tracking_id, read_id);
      case len(2):
        return add_part(r, place, "ground_truth_id", o.ground_truth_ids, read_id);
      case f64(3):
        return finite(r, place, "existence_probability", o.existence);
      case f64(4):
        return finite(r, place, "age", o.age_s);
      case var(5):
        return number(r, o.measurement_state);
      case len(6):
        return add_part(r, place, "sensor_id", o.sensor_ids, read_id);
      default:
        return false;
    }
  });
}

Candidate read_candidate(data_view bytes, Place& place) {
  Candidate c;
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case f64(1):
        return finite(r, place, "probability", c.probability);
      case var(2):
        return number(r, c.type);
      case len(3):
        return read_part(r, place, "vehicle_classification", -1, [&](data_view p, Place& at) {
          read_fields(p, at, [&](pbf_reader& v, uint32_t k) {
            if (k != var(1)) return false;
            return number(v, c.vehicle_type);
          });
        });
      default:
        return false;
    }
  });
  return c;
}

DetectedObject read_object(data_view bytes, Place& place) {
  DetectedObject o;
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case len(1):
        return read_part(r, place, "header", -1,
                         [&](data_view p, Place& at) { read_item_header(p, at, o); });
      case len(2):
        return into(r, place, "base", o.base, read_base);
      case len(3):
        return into(r, place, "base_rmse", o.base_rmse, read_base);
      case var(4):
        return number(r, o.reference_point);
      case var(5):
        return number(r, o.movement_state);
      case len(8):
        return add_part(r, place, "candidate", o.candidates, read_candidate);
      default:
        return false;
    }
  });
  return o;
}

ObjectHeader read_object_header(data_view bytes, Place& place) {
  ObjectHeader h;
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case len(1):
        return into(r, place, "timestamp", h.measurement_time, read_timestamp);
      case var(2):
        return number(r, h.cycle_counter);
      case var(3):
        return number(r, h.qualifier);
      default:
        return false;
    }
  });
  return h;
}

void read_features(data_view bytes, Place& place, std::vector<LidarDetectionData>& lidar) {
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    if (key != len(3)) return false;
    return add_part(r, place, "lidar_sensor", lidar, read_lidar);
  });
}

void read_area(data_view bytes, Place& place, std::vector<std::vector<Vec3>>& area) {
  const auto read_polygon = [&](data_view part, Place& at) {
    area.emplace_back();
    read_fields(part, at, [&](pbf_reader& r, uint32_t key) {
      if (key != len(1)) return false;
      return read_part(r, at, "vertex", int64_t(area.back().size()),
                       [&](data_view p, Place& in) { area.back().push_back(read_vector(p, in)); });
    });
  };
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    if (key != len(1)) return false;
    return read_part(r, place, "polygon", int64_t(area.size()), read_polygon);
  });
}

bool read_views(pbf_reader& r, Place& place, SensorData& d) {
  return read_part(r, place, "sensor_view", int64_t(d.views.size()), [&](data_view p, Place& at) {
    auto view = std::make_shared<SensorView>();
    read_view(p, at, *view);
    view->bytes.assign(p.data(), p.size());
    d.views.push_back(std::move(view));
  });
}

// Takes a field of SensorData; false for one that is kept as bytes.
bool take(pbf_reader& r, uint32_t key, Place& place, SensorData& d) {
  switch (key) {
    case len(1):
      return into(r, place, "version", d.version, read_version);
    case len(2):
      return into(r, place, "timestamp", d.timestamp, read_timestamp);
    case len(3):
      return into(r, place, "host_vehicle_location", d.host, read_base);
    case len(5):
      return into(r, place, "sensor_id", d.sensor_id, read_id);
    case len(6):
      return into(r, place, "mounting_position", d.mounting, read_mounting);
    case len(8):
      return read_views(r, place, d);
    case len(9):
      return into(r, place, "timestamp", d.last_measurement_time, read_timestamp);
    case len(12):
      return into(r, place, "moving_object_header", d.object_header, read_object_header);
    case len(13):
      return add_part(r, place, "moving_object", d.objects, read_object);
    case len(26):
      return read_part(r, place, "feature_data", -1,
                       [&](data_view p, Place& at) { read_features(p, at, d.lidar); });
    case len(27):
      return into(r, place, "logical_detection_data", d.logical, read_logical);
    case len(28):
      return read_part(r, place, "virtual_detection_area", -1,
                       [&](data_view p, Place& at) { read_area(p, at, d.free_area); });
    default:
      return false;
  }
}

}  // namespace

SensorData read_sensor_data(std::string_view bytes, std::string_view source) {
  Place place(source);
  SensorData d;
  const char* end = bytes.data() + bytes.size();
  const char* begin = bytes.data();  // Of the next field.
  read_fields({bytes.data(), bytes.size()}, place, [&](pbf_reader& r, uint32_t key) {
    if (!take(r, key, place, d)) {
      const bool is_provenance = r.tag() == kProvenanceField;
      r.skip();
      if (!is_provenance) d.other.append(begin, size_t(end - r.length() - begin));
    }
    begin = end - r.length();
    return true;
  });
  return d;
}

SensorViewConfiguration read_configuration(std::string_view bytes, std::string_view source) {
  Place place(source);
  SensorViewConfiguration c;
  std::optional<Timestamp> cycle;
  read_fields({bytes.data(), bytes.size()}, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case len(1):
        return into(r, place, "version", c.version, read_version);
      case len(2):
        return into(r, place, "sensor_id", c.sensor_id, read_id);
      case len(3):
        return into(r, place, "mounting_position", c.mounting, read_mounting);
      case f64(5):
        return finite(r, place, "field_of_view_horizontal", c.field_horizontal_rad);
      case f64(6):
        return finite(r, place, "field_of_view_vertical", c.field_vertical_rad);
      case f64(7):
        return finite(r, place, "range", c.range_m);
      case len(8):
        into(r, place, "timestamp", cycle, read_timestamp);
        c.cycle_s = cycle->s();
        return true;
      case len(1002):
        return add_part(r, place, "lidar_sensor_view_configuration", c.lidar,
                        read_lidar_configuration);
      default:
        return false;
    }
  });
  return c;
}

}  // namespace underbrush::osi
