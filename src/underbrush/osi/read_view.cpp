#include "underbrush/osi/read.hpp"
#include "underbrush/osi/read_parts.inl"

namespace underbrush::osi {
namespace {

using protozero::data_view;
using protozero::pbf_reader;

constexpr double kLongestFlightS = 1;  // Light travels 150 000 km there and back.
constexpr double kMostDb = 1000;
constexpr size_t kUsualReflectionBytes = 40;

bool text(pbf_reader& r, std::string& value) {
  value = r.get_string();
  return true;
}

void read_type(data_view bytes, Place& place, uint32_t& type) {
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    if (key != var(1)) return false;
    return number(r, type);
  });
}

MovingObject read_moving(data_view bytes, Place& place) {
  MovingObject m;
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case len(1):
        return read_part(r, place, "id", -1,
                         [&](data_view p, Place& at) { m.id = read_id(p, at); });
      case len(2):
        return read_part(r, place, "base", -1,
                         [&](data_view p, Place& at) { m.base = read_base(p, at); });
      case var(3):
        return number(r, m.type);
      case len(5):
        return read_part(r, place, "vehicle_attributes", -1, [&](data_view p, Place& at) {
          read_fields(p, at, [&](pbf_reader& a, uint32_t k) {
            if (k != len(4)) return false;
            return read_vector(a, at, "bbcenter_to_rear", m.centre_to_rear_m);
          });
        });
      case len(6):
        return read_part(r, place, "vehicle_classification", -1,
                         [&](data_view p, Place& at) { read_type(p, at, m.vehicle_type); });
      case len(7):
        return text(r, m.model_reference);
      default:
        return false;
    }
  });
  return m;
}

StationaryObject read_stationary(data_view bytes, Place& place) {
  StationaryObject s;
  const auto read_place = [&](data_view part, Place& at) {
    read_fields(part, at, [&](pbf_reader& r, uint32_t key) {
      switch (key) {
        case len(1):
          return read_extent(r, at, s.dimension_m);
        case len(2):
          return read_vector(r, at, "position", s.position_m);
        case len(3):
          return read_vector(r, at, "orientation", s.roll_pitch_yaw);
        default:
          return false;
      }
    });
  };
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case len(1):
        return read_part(r, place, "id", -1,
                         [&](data_view p, Place& at) { s.id = read_id(p, at); });
      case len(2):
        return read_part(r, place, "base", -1, read_place);
      case len(4):
        return text(r, s.model_reference);
      default:
        return false;
    }
  });
  return s;
}

void read_truth(data_view bytes, Place& place, GroundTruth& t) {
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case len(1):
        return read_version(r, place, t.version);
      case len(2):
        return read_timestamp(r, place, t.timestamp);
      case len(3):
        return read_id(r, place, "host_vehicle_id", t.host_vehicle_id);
      case len(4):
        return read_part(
            r, place, "stationary_object", int64_t(t.stationary.size()),
            [&](data_view p, Place& at) { t.stationary.push_back(read_stationary(p, at)); });
      case len(5):
        return read_part(r, place, "moving_object", int64_t(t.moving.size()),
                         [&](data_view p, Place& at) { t.moving.push_back(read_moving(p, at)); });
      case len(10):
        ++t.lanes;
        r.skip();
        return true;
      default:
        return false;
    }
  });
}

Reflection read_reflection(data_view bytes, Place& place) {
  Reflection f;
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case f64(1):
        return finite(r, place, "signal_strength", f.signal_db);
      case f64(2):
        return finite(r, place, "time_of_flight", f.time_of_flight_s);
      case f64(3):
        f.has_doppler = true;
        return finite(r, place, "doppler_shift", f.doppler_shift_hz);
      case len(5):
        return read_part(r, place, "normal_to_surface", -1, [&](data_view p, Place& at) {
          f.normal = read_vector(p, at).cast<float>();
        });
      case len(6):
        return read_part(r, place, "object_id", -1,
                         [&](data_view p, Place& at) { f.object_id = read_id(p, at); });
      default:
        return false;
    }
  });
  if (f.time_of_flight_s < 0 || f.time_of_flight_s > kLongestFlightS) {
    place.fail("time_of_flight", "negative or absurd");
  }
  if (std::abs(f.signal_db) > kMostDb) place.fail("signal_strength", "absurd");
  return f;
}

bool read_timings(pbf_reader& r, std::vector<uint32_t>& timings) {
  for (const uint32_t t : r.get_packed_uint32()) timings.push_back(t);
  return true;
}

}  // namespace

LidarConfiguration read_lidar_configuration(data_view bytes, Place& place) {
  LidarConfiguration c;
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case len(1):
        return read_id(r, place, "sensor_id", c.sensor_id);
      case len(2):
        return read_mounting(r, place, c.mounting);
      case f64(4):
        return finite(r, place, "field_of_view_horizontal", c.field_horizontal_rad);
      case f64(5):
        return finite(r, place, "field_of_view_vertical", c.field_vertical_rad);
      case var(6):
        return number(r, c.rays_horizontal);
      case var(7):
        return number(r, c.rays_vertical);
      case var(8):
        return number(r, c.most_interactions);
      case f64(9):
        return finite(r, place, "emitter_frequency", c.emitter_frequency_hz);
      case var(10):
        return number(r, c.beams);
      case len(11):
        return read_part(r, place, "directions", int64_t(c.directions.size()),
                         [&](data_view p, Place& at) {
                           const Vec3 d = read_vector(p, at);
                           if (!(d.norm() > 1e-6 && d.norm() < 1e6)) at.fail("", "no direction");
                           c.directions.push_back(d.normalized().cast<float>());
                         });
      case var(12):
        return number(r, c.timings_us.emplace_back());
      case len(12):
        return read_timings(r, c.timings_us);
      default:
        return false;
    }
  });
  return c;
}

LidarSensorView read_lidar_view(data_view bytes, Place& place) {
  LidarSensorView v;
  v.reflections.reserve(bytes.size() / kUsualReflectionBytes);
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case len(1):
        return read_part(r, place, "view_configuration", -1, [&](data_view p, Place& at) {
          v.configuration = read_lidar_configuration(p, at);
        });
      case len(2):
        return read_part(
            r, place, "reflection", int64_t(v.reflections.size()),
            [&](data_view p, Place& at) { v.reflections.push_back(read_reflection(p, at)); });
      default:
        return false;
    }
  });
  return v;
}

void read_view(data_view bytes, Place& place, SensorView& v) {
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case len(1):
        return read_version(r, place, v.version);
      case len(2):
        return read_timestamp(r, place, v.timestamp);
      case len(3):
        return read_id(r, place, "sensor_id", v.sensor_id);
      case len(4):
        return read_mounting(r, place, v.mounting);
      case len(7):
        if (!v.truth) v.truth.emplace();
        return read_part(r, place, "global_ground_truth", -1,
                         [&](data_view p, Place& at) { read_truth(p, at, *v.truth); });
      case len(8):
        return read_id(r, place, "host_vehicle_id", v.host_vehicle_id);
      case len(1002):
        return read_part(
            r, place, "lidar_sensor_view", int64_t(v.lidar.size()),
            [&](data_view p, Place& at) { v.lidar.push_back(read_lidar_view(p, at)); });
      default:
        return false;
    }
  });
}

GroundTruth read_ground_truth(std::string_view bytes, std::string_view source) {
  Place place(source);
  GroundTruth t;
  read_truth({bytes.data(), bytes.size()}, place, t);
  return t;
}

SensorView read_sensor_view(std::string bytes, std::string_view source) {
  Place place(source);
  SensorView v;
  read_view({bytes.data(), bytes.size()}, place, v);
  v.bytes = std::move(bytes);
  return v;
}

}  // namespace underbrush::osi
