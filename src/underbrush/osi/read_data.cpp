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
        return read_one_id(r, place, "tracking_id", o.tracking_id);
      case len(2):
        return add_id(r, place, "ground_truth_id", o.ground_truth_ids);
      case f64(3):
        return finite(r, place, "existence_probability", o.existence);
      case f64(4):
        return finite(r, place, "age", o.age_s);
      case var(5):
        return number(r, o.measurement_state);
      case len(6):
        return add_id(r, place, "sensor_id", o.sensor_ids);
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
        return read_part(r, place, "base", -1,
                         [&](data_view p, Place& at) { o.base = read_base(p, at); });
      case len(3):
        return read_part(r, place, "base_rmse", -1,
                         [&](data_view p, Place& at) { o.base_rmse = read_base(p, at); });
      case var(4):
        return number(r, o.reference_point);
      case var(5):
        return number(r, o.movement_state);
      case len(8):
        return read_part(
            r, place, "candidate", int64_t(o.candidates.size()),
            [&](data_view p, Place& at) { o.candidates.push_back(read_candidate(p, at)); });
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
        return read_timestamp(r, place, h.measurement_time);
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
    return read_part(r, place, "lidar_sensor", int64_t(lidar.size()),
                     [&](data_view p, Place& at) { lidar.push_back(read_lidar(p, at)); });
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
      return read_version(r, place, d.version);
    case len(2):
      return read_timestamp(r, place, d.timestamp);
    case len(3):
      return read_part(r, place, "host_vehicle_location", -1,
                       [&](data_view p, Place& at) { d.host = read_base(p, at); });
    case len(5):
      return read_id(r, place, "sensor_id", d.sensor_id);
    case len(6):
      return read_mounting(r, place, d.mounting);
    case len(8):
      return read_views(r, place, d);
    case len(9):
      return read_timestamp(r, place, d.last_measurement_time);
    case len(12):
      return read_part(r, place, "moving_object_header", -1, [&](data_view p, Place& at) {
        d.object_header = read_object_header(p, at);
      });
    case len(13):
      return read_part(r, place, "moving_object", int64_t(d.objects.size()),
                       [&](data_view p, Place& at) { d.objects.push_back(read_object(p, at)); });
    case len(26):
      return read_part(r, place, "feature_data", -1,
                       [&](data_view p, Place& at) { read_features(p, at, d.lidar); });
    case len(27):
      return read_part(r, place, "logical_detection_data", -1,
                       [&](data_view p, Place& at) { d.logical = read_logical(p, at); });
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
        return read_version(r, place, c.version);
      case len(2):
        return read_id(r, place, "sensor_id", c.sensor_id);
      case len(3):
        return read_mounting(r, place, c.mounting);
      case f64(5):
        return finite(r, place, "field_of_view_horizontal", c.field_horizontal_rad);
      case f64(6):
        return finite(r, place, "field_of_view_vertical", c.field_vertical_rad);
      case f64(7):
        return finite(r, place, "range", c.range_m);
      case len(8):
        read_timestamp(r, place, cycle);
        c.cycle_s = cycle->s();
        return true;
      case len(1002):
        return read_part(
            r, place, "lidar_sensor_view_configuration", int64_t(c.lidar.size()),
            [&](data_view p, Place& at) { c.lidar.push_back(read_lidar_configuration(p, at)); });
      default:
        return false;
    }
  });
  return c;
}

}  // namespace underbrush::osi
