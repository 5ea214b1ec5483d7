#include <bit>
#include <cstring>

#include "underbrush/osi/read.hpp"
#include "underbrush/osi/read_parts.inl"

namespace underbrush::osi {
namespace {

using protozero::data_view;
using protozero::pbf_reader;

constexpr double kLongestFlightS = 1;  // Light travels 150 000 km there and back.
constexpr double kMostDb = 1000;
constexpr size_t kLeastReflectionBytes = 20;  // Of a ray that met something.

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
        return into(r, place, "id", m.id, read_id);
      case len(2):
        return into(r, place, "base", m.base, read_base);
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
        return into(r, place, "id", s.id, read_id);
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
        return into(r, place, "version", t.version, read_version);
      case len(2):
        return into(r, place, "timestamp", t.timestamp, read_timestamp);
      case len(3):
        return into(r, place, "host_vehicle_id", t.host_vehicle_id, read_id);
      case len(4):
        return add_part(r, place, "stationary_object", t.stationary, read_stationary);
      case len(5):
        return add_part(r, place, "moving_object", t.moving, read_moving);
      case len(10):
        ++t.lanes;
        r.skip();
        return true;
      default:
        return false;
    }
  });
}

bool is_possible(const Reflection& f) {
  return f.time_of_flight_s >= 0 && f.time_of_flight_s <= kLongestFlightS &&
         std::abs(f.signal_db) <= kMostDb;
}

// Reads the layout that nearly all reflections have: signal, time of flight and perhaps the number
// of an object. Returns false for any other and for values that are out of range.
bool read_usual(data_view bytes, Reflection& f) {
  constexpr size_t kNumbers = 18;
  const char* at = bytes.data();
  if (std::endian::native != std::endian::little || bytes.size() < kNumbers ||
      at[0] != char(f64(1)) || at[9] != char(f64(2))) {
    return false;
  }
  std::memcpy(&f.signal_db, at + 1, sizeof f.signal_db);
  std::memcpy(&f.time_of_flight_s, at + 10, sizeof f.time_of_flight_s);
  if (!is_possible(f)) return false;
  if (bytes.size() == kNumbers) return true;
  constexpr size_t kId = kNumbers + 3, kLongest = kId + 5;  // Where the number begins and ends.
  const size_t end = bytes.size();
  if (end <= kId || end > kLongest || at[18] != char(len(6)) || size_t(at[19]) != end - 20 ||
      at[20] != char(var(1))) {
    return false;
  }
  f.object_id = 0;
  for (size_t k = kId; k < end; ++k) {  // Seven bits a byte; the last byte has no mark.
    const auto byte = uint8_t(at[k]);
    if ((byte < 0x80) != (k + 1 == end)) return false;
    f.object_id |= uint64_t(byte & 0x7F) << (7 * (k - kId));
  }
  return true;
}

Reflection read_reflection(data_view bytes, Place& place) {
  Reflection f;
  if (read_usual(bytes, f)) return f;
  f = {};
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
        return into(r, place, "object_id", f.object_id, read_id);
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
        return into(r, place, "sensor_id", c.sensor_id, read_id);
      case len(2):
        return into(r, place, "mounting_position", c.mounting, read_mounting);
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
                           // A unit vector in single precision stays as it was written.
                           const bool is_unit = std::abs(d.squaredNorm() - 1) < 1e-6;
                           c.directions.push_back((is_unit ? d : d.normalized()).cast<float>());
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
  v.reflections.reserve(bytes.size() / kLeastReflectionBytes);
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case len(1):
        return into(r, place, "view_configuration", v.configuration, read_lidar_configuration);
      case len(2):
        return add_part(r, place, "reflection", v.reflections, read_reflection);
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
        return into(r, place, "version", v.version, read_version);
      case len(2):
        return into(r, place, "timestamp", v.timestamp, read_timestamp);
      case len(3):
        return into(r, place, "sensor_id", v.sensor_id, read_id);
      case len(4):
        return into(r, place, "mounting_position", v.mounting, read_mounting);
      case len(7):
        if (!v.truth) v.truth.emplace();
        return read_part(r, place, "global_ground_truth", -1,
                         [&](data_view p, Place& at) { read_truth(p, at, *v.truth); });
      case len(8):
        return into(r, place, "host_vehicle_id", v.host_vehicle_id, read_id);
      case len(1002):
        return add_part(r, place, "lidar_sensor_view", v.lidar, read_lidar_view);
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
