#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <sstream>

#include "underbrush/core/check.hpp"
#include "underbrush/sensor/catalogue.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::sensor {
namespace {

constexpr double kDegree = M_PI / 180;

/// A YAML map whose keys must all be used.
class Map {
 public:
  Map(std::string file, std::string place, YAML::Node node,
      std::initializer_list<std::string_view> keys)
      : file_(std::move(file)), place_(std::move(place)), node_(std::move(node)) {
    if (!node_.IsMap()) fail("", "expected lines of KEY: VALUE");
    for (const auto& entry : node_) {
      const auto key = entry.first.as<std::string>();
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) fail(key, "unknown key");
    }
  }

  YAML::Node child(const std::string& key) const {
    if (!node_[key]) fail(key, "missing");
    return node_[key];
  }
  bool has(const std::string& key) const { return bool(node_[key]); }

  template <class T>
  T get(const std::string& key) const {
    const YAML::Node value = child(key);
    try {
      return value.as<T>();
    } catch (const YAML::Exception&) {
      fail(key, "not the expected kind of value");
    }
  }
  template <class T>
  T get(const std::string& key, T fallback) const {
    return has(key) ? get<T>(key) : fallback;
  }

  [[noreturn]] void fail(const std::string& key, const std::string& reason) const {
    throw FormatError(file_, place_.empty() || key.empty() ? place_ + key : place_ + "." + key,
                      reason);
  }

 private:
  std::string file_, place_;
  YAML::Node node_;
};

std::vector<Channel> read_channels(const std::string& file, const YAML::Node& node) {
  const Map map(file, "channels", node, {"elevation_deg", "azimuth_deg", "time_us", "z_mm"});
  const auto elevation = map.get<std::vector<double>>("elevation_deg");
  std::vector<Channel> channels(elevation.size());
  const auto fill = [&](const char* key, double unit, double Channel::*field) {
    if (!map.has(key)) return;
    const auto values = map.get<std::vector<double>>(key);
    if (values.size() != channels.size()) map.fail(key, "needs one value per elevation");
    for (size_t i = 0; i < values.size(); ++i) channels[i].*field = values[i] * unit;
  };
  fill("elevation_deg", kDegree, &Channel::elevation_rad);
  fill("azimuth_deg", kDegree, &Channel::azimuth_rad);
  fill("time_us", 1e-6, &Channel::time_s);
  fill("z_mm", 1e-3, &Channel::z_m);
  return channels;
}

Sensor read_sensor(const std::string& file, const YAML::Node& root) {
  const Map map(
      file, "", root,
      {"name", "title", "kind", "rate_hz", "firing_period_us", "firings_per_packet", "rotation",
       "start_azimuth_deg", "min_range_m", "max_range_m", "range_sigma_m", "range_resolution_m",
       "divergence_mrad", "aperture_mm", "wavelength_nm", "channels", "sources"});
  if (map.get<std::string>("kind") != "spinning") map.fail("kind", "only 'spinning' is known");
  const auto rotation = map.get<std::string>("rotation");
  if (rotation != "clockwise" && rotation != "counterclockwise") {
    map.fail("rotation", "must be clockwise or counterclockwise");
  }
  Sensor s;
  s.name = map.get<std::string>("name");
  s.title = map.get("title", s.name);
  s.sources = map.get("sources", std::vector<std::string>{});
  s.channels = read_channels(file, map.child("channels"));
  s.rate_hz = map.get<double>("rate_hz");
  s.firing_period_s = map.get<double>("firing_period_us") * 1e-6;
  s.clockwise = rotation == "clockwise";
  s.start_azimuth_rad = map.get("start_azimuth_deg", 180.0) * kDegree;
  s.firings_per_packet = map.get("firings_per_packet", 1);
  s.min_range_m = map.get<double>("min_range_m");
  s.max_range_m = map.get<double>("max_range_m");
  s.range_sigma_m = map.get("range_sigma_m", 0.0);
  s.range_resolution_m = map.get("range_resolution_m", 0.0);
  const auto divergence = map.get("divergence_mrad", std::vector<double>{0, 0});
  if (divergence.size() != 2) map.fail("divergence_mrad", "needs [horizontal, vertical]");
  s.beam.divergence_rad = {divergence[0] * 1e-3, divergence[1] * 1e-3};
  s.beam.exit_diameter_m = map.get("aperture_mm", 0.0) * 1e-3;
  s.wavelength_m = map.get("wavelength_nm", 0.0) * 1e-9;
  try {
    s.check();
  } catch (const std::invalid_argument& e) {
    throw FormatError(file, "", e.what());
  }
  return s;
}

Sensor parse(const std::string& file, const std::string& text) {
  try {
    return read_sensor(file, YAML::Load(text));
  } catch (const YAML::Exception& e) {
    throw FormatError(file, "line " + std::to_string(e.mark.line + 1), e.msg);
  }
}

}  // namespace

Sensor load(std::string_view name_or_yaml_path) {
  const std::string name(name_or_yaml_path);
  for (const CatalogueEntry& entry : catalogue()) {
    if (entry.name == name) return parse(name, std::string(entry.yaml));
  }
  if (!std::filesystem::is_regular_file(name)) {
    std::string known;
    for (const std::string& n : names()) known += " " + n;
    throw std::invalid_argument("no sensor '" + name + "', nor such a file; known:" + known);
  }
  std::ifstream in(name, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw IoError(name + ": cannot be read");
  return parse(name, text.str());
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const CatalogueEntry& entry : catalogue()) all.emplace_back(entry.name);
  return all;
}

}  // namespace underbrush::sensor
