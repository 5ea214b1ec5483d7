#include "underbrush/perception/rig.hpp"

#include <algorithm>
#include <filesystem>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/sensor/catalogue.hpp"
#include "underbrush/sensor/sensor.hpp"
#include "underbrush/sensor/yaml_map.inl"

namespace underbrush::perception {
namespace {

using sensor::YamlMap;

constexpr size_t kMostSensors = 255;                   // The column of a log is a byte.
constexpr double kFarthest = 100, kMostTurnDeg = 720;  // m from the vehicle's origin, degrees
constexpr double kMostMs = 1e6;

Vec3 vector_of(const YamlMap& map, const std::string& key, double most) {
  const auto v = map.get<std::vector<double>>(key, {0, 0, 0});
  if (v.size() != 3) map.fail(key, "needs three numbers");
  for (const double x : v) {
    if (std::abs(x) <= most) continue;
    map.fail(key, "must be numbers of at most " + std::to_string(int(most)));
  }
  return {v[0], v[1], v[2]};
}

double milliseconds(const YamlMap& map, const std::string& key) {
  const double ms = map.get(key, 0.0);
  if (!(std::abs(ms) <= kMostMs)) map.fail(key, "must be a number of at most 1e6");
  return ms / 1000;
}

// A sensor that is not in the catalogue is a file beside the rig's.
std::string sensor_of(const YamlMap& map, const std::string& file) {
  auto name = map.get<std::string>("sensor");
  const auto known = sensor::catalogue();
  if (std::any_of(known.begin(), known.end(), [&](const auto& e) { return e.name == name; })) {
    return name;
  }
  const auto beside = std::filesystem::path(file).parent_path() / name;
  if (is_file(beside)) {
    try {
      sensor::load(beside.string());
    } catch (const FormatError& e) {
      map.fail("sensor", e.what());
    }
    return beside.string();
  }
  map.fail("sensor", "no sensor of the catalogue, nor a file beside the rig's");
}

MountedSensor mounted(const YamlMap& map, const std::string& file) {
  MountedSensor m;
  m.name = map.get<std::string>("name");
  m.sensor = sensor_of(map, file);
  const Vec3 turn = vector_of(map, "rotation_deg", kMostTurnDeg) * kDegree;
  m.vehicle_from_sensor.translation = vector_of(map, "position_m", kFarthest);
  m.vehicle_from_sensor.rotation = Eigen::AngleAxisd(turn.z(), Vec3::UnitZ()) *
                                   Eigen::AngleAxisd(turn.y(), Vec3::UnitY()) *
                                   Eigen::AngleAxisd(turn.x(), Vec3::UnitX());
  m.latency_s = milliseconds(map, "latency_ms");
  if (m.latency_s < 0) map.fail("latency_ms", "must not be negative");
  m.clock_offset_s = milliseconds(map, "clock_offset_ms");
  return m;
}

Rig rig_of(const std::string& file, const YAML::Node& node) {
  const YamlMap root(file, "", node, {"name", "sensors", "sources"});
  Rig rig;
  rig.name = root.get<std::string>("name");
  const YAML::Node list = root.child("sensors");
  if (!list.IsSequence() || list.size() == 0 || list.size() > kMostSensors) {
    root.fail("sensors", "expected a list of 1 to 255 sensors");
  }
  for (size_t k = 0; k < list.size(); ++k) {
    const YamlMap map(
        file, "sensors[" + std::to_string(k) + "]", list[k],
        {"name", "sensor", "position_m", "rotation_deg", "latency_ms", "clock_offset_ms"});
    rig.sensors.push_back(mounted(map, file));
    for (size_t j = 0; j < k; ++j) {
      if (rig.sensors[j].name == rig.sensors[k].name) map.fail("name", "occurs twice");
    }
  }
  return rig;
}

}  // namespace

Rig load_rig(const std::string& path) {
  const std::string text = sensor::text_of(path);
  try {
    return rig_of(path, YAML::Load(text));
  } catch (const YAML::Exception& e) {
    throw FormatError(path, "line " + std::to_string(e.mark.line + 1), e.msg);
  }
}

}  // namespace underbrush::perception
