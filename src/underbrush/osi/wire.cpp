#include "underbrush/osi/wire.inl"

namespace underbrush::osi {
namespace {

using protozero::data_view;
using protozero::pbf_reader;

constexpr int64_t kLatestSecond = 1'000'000'000'000;
constexpr double kMostExtent = 1e6;

}  // namespace

void Place::fail(const char* field, const char* reason) const {
  std::string text;
  for (size_t k = 0; k < depth_; ++k) {
    if (!text.empty()) text += '.';
    text += steps_[k].name;
    if (steps_[k].index >= 0) text += '[' + std::to_string(steps_[k].index) + ']';
  }
  if (*field && !text.empty()) text += '.';
  throw FormatError(source_, text + field, reason);
}

Timestamp read_timestamp(data_view bytes, Place& place) {
  Timestamp t;
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case var(1):
        return number(r, t.seconds);
      case var(2):
        return number(r, t.nanos);
      default:
        return false;
    }
  });
  if (t.nanos >= 1'000'000'000) place.fail("nanos", "a second or more");
  if (t.seconds > kLatestSecond || t.seconds < -kLatestSecond) place.fail("seconds", "absurd");
  return t;
}

Version read_version(data_view bytes, Place& place) {
  Version v{0, 0, 0};
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case var(1):
        return number(r, v.major);
      case var(2):
        return number(r, v.minor);
      case var(3):
        return number(r, v.patch);
      default:
        return false;
    }
  });
  if (v.major != 3) place.fail("version_major", "only version 3 of OSI can be read");
  return v;
}

uint64_t read_id(data_view bytes, Place& place) {
  uint64_t id = 0;
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    if (key != var(1)) return false;
    return number(r, id);
  });
  return id;
}

Vec3 read_vector(data_view bytes, Place& place, const Vec3& before) {
  Vec3 v = before;
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case f64(1):
        return finite(r, place, "x", v.x());
      case f64(2):
        return finite(r, place, "y", v.y());
      case f64(3):
        return finite(r, place, "z", v.z());
      default:
        return false;
    }
  });
  return v;
}

bool read_vector(pbf_reader& r, Place& place, const char* name, std::optional<Vec3>& value) {
  return read_part(r, place, name, -1, [&](data_view part, Place& at) {
    value = read_vector(part, at, value.value_or(Vec3::Zero()));
  });
}

bool read_extent(pbf_reader& r, Place& place, std::optional<Vec3>& value) {
  read_vector(r, place, "dimension", value);
  if (value->minCoeff() < 0 || value->maxCoeff() > kMostExtent) {
    place.fail("dimension", "negative or absurd");
  }
  return true;
}

Mounting read_mounting(data_view bytes, Place& place) {
  Mounting m;
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case len(1):
        return read_vector(r, place, "position", m.position_m);
      case len(2):
        return read_vector(r, place, "orientation", m.roll_pitch_yaw);
      default:
        return false;
    }
  });
  return m;
}

BaseMoving read_base(data_view bytes, Place& place) {
  BaseMoving b;
  read_fields(bytes, place, [&](pbf_reader& r, uint32_t key) {
    switch (key) {
      case len(1):
        return read_extent(r, place, b.dimension_m);
      case len(2):
        return read_vector(r, place, "position", b.position_m);
      case len(3):
        return read_vector(r, place, "orientation", b.roll_pitch_yaw);
      case len(4):
        return read_vector(r, place, "velocity", b.velocity_m_s);
      case len(5):
        return read_vector(r, place, "acceleration", b.acceleration_m_s2);
      case len(6):
        return read_vector(r, place, "orientation_rate", b.turn_rate_rad_s);
      default:
        return false;
    }
  });
  return b;
}

}  // namespace underbrush::osi
