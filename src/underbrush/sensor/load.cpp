#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <sstream>

#include "underbrush/core/check.hpp"
#include "underbrush/core/names.hpp"
#include "underbrush/sensor/angles.hpp"
#include "underbrush/sensor/catalogue.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::sensor {
namespace {

constexpr double kDegree = M_PI / 180;

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw FormatError(path, "", "no such file, or it cannot be read");
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// A YAML map whose keys must all be used.
class Map {
 public:
  Map(std::string file, std::string place, const YAML::Node& node,
      std::initializer_list<std::string_view> keys)
      : file_(std::move(file)), place_(std::move(place)), node_(node) {
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

  /// The map under `key`.
  Map map(const std::string& key, std::initializer_list<std::string_view> keys) const {
    return Map(file_, place_.empty() ? key : place_ + "." + key, child(key), keys);
  }
  /// One of the named values; without the key, that of `fallback` (which may be none).
  template <class T>
  T choice(const std::string& key, std::initializer_list<std::pair<const char*, T>> values,
           const char* fallback = nullptr) const {
    const auto word = fallback ? get<std::string>(key, fallback) : get<std::string>(key);
    std::string known;
    for (const auto& [name, value] : values) {
      if (word == name) return value;
      known += std::string(known.empty() ? "" : ", ") + name;
    }
    fail(key, "must be one of " + known);
  }
  std::array<double, 2> pair(const std::string& key) const {
    const auto values = get<std::vector<double>>(key);
    if (values.size() != 2) fail(key, "needs two numbers");
    return {values[0], values[1]};
  }
  std::array<double, 2> pair(const std::string& key, const std::array<double, 2>& fallback) const {
    return has(key) ? pair(key) : fallback;
  }
  const std::string& file() const { return file_; }

  [[noreturn]] void fail(const std::string& key, const std::string& reason) const {
    throw FormatError(file_, place_.empty() || key.empty() ? place_ + key : place_ + "." + key,
                      reason);
  }

 private:
  std::string file_, place_;
  YAML::Node node_;
};

// A list, or {first, last, count}: evenly spaced, both ends included.
std::vector<double> read_elevations(const Map& channels) {
  if (!channels.child("elevation_deg").IsMap())
    return channels.get<std::vector<double>>("elevation_deg");
  const Map even = channels.map("elevation_deg", {"first", "last", "count"});
  const auto first = even.get<double>("first"), last = even.get<double>("last");
  const auto count = even.get<int>("count");
  if (count < 2 || count > 65535) even.fail("count", "must be 2 to 65535");
  std::vector<double> out(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) out[size_t(i)] = first + (last - first) * i / (count - 1);
  return out;
}

std::vector<Channel> read_channels(const Map& root, std::vector<std::array<double, 2>>* windows) {
  const Map map = root.map("channels", {"elevation_deg", "azimuth_deg", "time_us", "z_mm",
                                        "azimuth_from_deg", "azimuth_to_deg"});
  const std::vector<double> elevation = read_elevations(map);
  std::vector<Channel> channels(elevation.size());
  for (size_t i = 0; i < channels.size(); ++i) channels[i].elevation_rad = elevation[i] * kDegree;
  const auto values_of = [&](const char* key) {
    auto values = map.get<std::vector<double>>(key);
    if (values.size() != channels.size()) map.fail(key, "needs one value per elevation");
    return values;
  };
  const auto fill = [&](const char* key, double unit, double Channel::*field) {
    if (!map.has(key)) return;
    const std::vector<double> values = values_of(key);
    for (size_t i = 0; i < values.size(); ++i) channels[i].*field = values[i] * unit;
  };
  fill("azimuth_deg", kDegree, &Channel::azimuth_rad);
  fill("time_us", 1e-6, &Channel::time_s);
  fill("z_mm", 1e-3, &Channel::z_m);
  if (windows == nullptr) {
    if (map.has("azimuth_from_deg")) map.fail("azimuth_from_deg", "only for a sweep");
    if (map.has("azimuth_to_deg")) map.fail("azimuth_to_deg", "only for a sweep");
    return channels;
  }
  const std::vector<double> from = values_of("azimuth_from_deg"), to = values_of("azimuth_to_deg");
  for (size_t i = 0; i < channels.size(); ++i) {
    windows->push_back({std::min(from[i], to[i]) * kDegree, std::max(from[i], to[i]) * kDegree});
  }
  return channels;
}

void read_rotation(const Map& map, Sensor& s) {
  s.rate_hz = map.get<double>("rate_hz");
  s.firing_period_s = map.get<double>("firing_period_us") * 1e-6;
  s.clockwise = map.choice<bool>("rotation", {{"clockwise", true}, {"counterclockwise", false}});
  s.start_azimuth_rad = map.get("start_azimuth_deg", 180.0) * kDegree;
}

// The firings of one turn, each channel within its own window.
void read_sweep(const Map& map, Sensor& s) {
  read_rotation(map, s);
  std::vector<std::array<double, 2>> window;
  s.channels = read_channels(map, &window);
  s.cycle_s = 1 / s.rate_hz;
  const double firings = s.firings_per_revolution();
  if (!(firings >= 1 && firings < 1e6) || std::abs(firings - std::round(firings)) > 1e-3) {
    map.fail("firing_period_us", "a sweep needs a whole number of firings a turn");
  }
  const double step = 2 * M_PI / std::round(firings);
  for (size_t k = 0; k < size_t(std::round(firings)); ++k) {
    for (const uint16_t ring : s.firing_order()) {
      const Channel& c = s.channels[ring];
      const double azimuth =
          signed_angle(s.start_azimuth_rad + s.turn() * step * double(k)) + c.azimuth_rad;
      if (azimuth < window[ring][0] - 1e-9 || azimuth > window[ring][1] + 1e-9) continue;
      s.shots.push_back(
          {azimuth, c.elevation_rad, double(k) / std::round(firings) * s.cycle_s + c.time_s, ring});
    }
  }
}

void read_raster(const Map& root, Sensor& s) {
  const Map map =
      root.map("raster", {"azimuth_deg", "elevation_deg", "step_deg", "order", "serpentine"});
  const auto azimuth = map.pair("azimuth_deg"), elevation = map.pair("elevation_deg");
  const auto step = map.pair("step_deg");
  const auto lines = [&](const std::array<double, 2>& bounds, double by) {
    const double n = std::abs(bounds[1] - bounds[0]) / by;
    if (!(by > 0) || !(n < 65534))
      map.fail("step_deg", "must be positive, for at most 65534 steps");
    return uint32_t(std::lround(n)) + 1;
  };
  s.raster.columns = lines(azimuth, step[0]);
  s.raster.rows = lines(elevation, step[1]);
  const auto towards = [&](const std::array<double, 2>& bounds, uint32_t n, double by) {
    return (bounds[0] + std::copysign((n - 1) * by, bounds[1] - bounds[0])) * kDegree;
  };
  s.raster.azimuth_from_rad = azimuth[0] * kDegree;
  s.raster.azimuth_to_rad = towards(azimuth, s.raster.columns, step[0]);
  s.raster.elevation_from_rad = elevation[0] * kDegree;
  s.raster.elevation_to_rad = towards(elevation, s.raster.rows, step[1]);
  s.raster.by_columns = map.choice<bool>("order", {{"rows", false}, {"columns", true}}, "rows");
  s.raster.serpentine = map.get("serpentine", false);
  s.firing_period_s = 1 / root.get<double>("shots_per_s");
  s.rate_hz = 1 / (s.firing_period_s * double(s.raster.size()));
}

void read_directions(const Map& map, Sensor& s) {
  s.rate_hz = map.get<double>("rate_hz");
  s.cycle_s = map.get<double>("cycle_s");
  if (!(s.cycle_s > 0)) map.fail("cycle_s", "must be positive");
  const auto name = map.get<std::string>("directions");
  for (const CatalogueEntry& entry : catalogue_tables()) {
    if (entry.name == name) s.shots = shots_from_csv(name, entry.text, s.cycle_s);
  }
  if (s.shots.empty()) {
    const auto path = (std::filesystem::path(map.file()).parent_path() / name).string();
    s.shots = shots_from_csv(path, text_of(path), s.cycle_s);
  }
  s.firing_period_s = s.cycle_s / double(s.shots.size());
}

void read_beam(const Map& map, Sensor& s) {
  const auto divergence = map.pair("divergence_mrad", {0, 0});
  s.beam.divergence_rad = {divergence[0] * 1e-3, divergence[1] * 1e-3};
  s.beam.exit_diameter_m = map.get("aperture_mm", 0.0) * 1e-3;
  s.beam.encoder_step_rad = map.get("encoder_step_deg", 0.0) * kDegree;
  s.beam.growth =
      map.choice<Growth>("growth", {{"cone", Growth::kCone}, {"waist", Growth::kWaist}}, "cone");
  s.beam.profile = map.choice<Profile>("profile",
                                       {{"uniform", Profile::kUniform},
                                        {"gaussian", Profile::kGaussian},
                                        {"table", Profile::kTable}},
                                       "gaussian");
  if (map.has("profile_table") != (s.beam.profile == Profile::kTable)) {
    map.fail("profile_table", "belongs to profile: table, rows of numbers");
  }
  if (map.has("profile_table")) {
    for (const auto& row : map.get<std::vector<std::vector<double>>>("profile_table")) {
      if (s.beam.table.empty()) s.beam.table_columns = int(row.size());
      if (int(row.size()) != s.beam.table_columns)
        map.fail("profile_table", "rows differ in length");
      s.beam.table.insert(s.beam.table.end(), row.begin(), row.end());
    }
  }
  const auto sub_rays = map.pair("sub_rays", {9, 9});
  s.sub_rays = {int(sub_rays[0]), int(sub_rays[1])};
  s.wavelength_m = map.get("wavelength_nm", 0.0) * 1e-9;
}

void read_receiver(const Map& root, SignalChain& c) {
  if (!root.has("receiver")) return;
  const Map map = root.map(
      "receiver", {"pulse", "pulse_ns", "response_ns", "sample_ns", "timing", "threshold_snr",
                   "detects", "min_gap_m", "saturation_snr", "returns", "max_echoes", "intensity",
                   "intensity_scale", "intensity_step", "intensity_max", "width_step_m"});
  c.pulse = map.choice<Pulse>(
      "pulse", {{"gaussian", Pulse::kGaussian}, {"q_switched", Pulse::kQSwitched}}, "gaussian");
  c.pulse_fwhm_s = map.get("pulse_ns", c.pulse_fwhm_s * 1e9) * 1e-9;
  c.receiver_fwhm_s = map.get("response_ns", c.receiver_fwhm_s * 1e9) * 1e-9;
  c.sample_s = map.get("sample_ns", c.sample_s * 1e9) * 1e-9;
  c.timing = map.choice<Timing>("timing",
                                {{"peak", Timing::kPeak},
                                 {"leading_edge", Timing::kLeadingEdge},
                                 {"constant_fraction", Timing::kConstantFraction}},
                                "peak");
  c.threshold_snr = map.get("threshold_snr", c.threshold_snr);
  if (map.has("detects")) {
    const Map detects = map.map("detects", {"range_m", "reflectance"});
    c.detection_range_m = detects.get<double>("range_m");
    c.detection_reflectance = detects.get<double>("reflectance");
  }
  c.min_gap_m = map.get("min_gap_m", c.min_gap_m);
  c.saturation_snr = map.get("saturation_snr", c.saturation_snr);
  c.mode = map.choice<ReturnMode>("returns",
                                  {{"strongest", ReturnMode::kStrongest},
                                   {"first", ReturnMode::kFirst},
                                   {"last", ReturnMode::kLast},
                                   {"all", ReturnMode::kAll}},
                                  "strongest");
  c.max_echoes = map.get("max_echoes", c.max_echoes);
  c.intensity = map.choice<Intensity>(
      "intensity", {{"signal", Intensity::kSignal}, {"reflectance", Intensity::kReflectance}},
      "reflectance");
  c.intensity_scale = map.get("intensity_scale", c.intensity_scale);
  c.intensity_resolution = map.get("intensity_step", c.intensity_resolution);
  c.intensity_most = map.get("intensity_max", c.intensity_most);
  c.width_resolution_m = map.get("width_step_m", c.width_resolution_m);
}

Sensor read_sensor(const std::string& file, const YAML::Node& root) {
  const Map map(file, "", root,
                {"name",
                 "title",
                 "kind",
                 "rate_hz",
                 "firing_period_us",
                 "firings_per_packet",
                 "rotation",
                 "start_azimuth_deg",
                 "shots_per_s",
                 "raster",
                 "directions",
                 "cycle_s",
                 "min_range_m",
                 "max_range_m",
                 "range_sigma_m",
                 "range_resolution_m",
                 "divergence_mrad",
                 "aperture_mm",
                 "encoder_step_deg",
                 "growth",
                 "profile",
                 "profile_table",
                 "sub_rays",
                 "wavelength_nm",
                 "receiver",
                 "channels",
                 "sources"});
  Sensor s;
  s.name = map.get<std::string>("name");
  s.title = map.get("title", s.name);
  s.sources = map.get("sources", std::vector<std::string>{});
  const auto kind = map.get<std::string>("kind");
  s.kind = map.choice<Kind>("kind", {{"spinning", Kind::kSpinning},
                                     {"raster", Kind::kRaster},
                                     {"sweep", Kind::kSequence},
                                     {"directions", Kind::kSequence}});
  if (kind == "spinning") {
    read_rotation(map, s);
    s.channels = read_channels(map, nullptr);
  } else if (kind == "sweep") {
    read_sweep(map, s);
  } else if (kind == "raster") {
    read_raster(map, s);
  } else {
    read_directions(map, s);
  }
  s.firings_per_packet = map.get("firings_per_packet", 1);
  s.min_range_m = map.get<double>("min_range_m");
  s.max_range_m = map.get<double>("max_range_m");
  s.range_sigma_m = map.get("range_sigma_m", 0.0);
  s.range_resolution_m = map.get("range_resolution_m", 0.0);
  read_beam(map, s);
  read_receiver(map, s.signal);
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
    if (entry.name == name) return parse(name, std::string(entry.text));
  }
  if (std::filesystem::is_regular_file(name)) return parse(name, text_of(name));
  std::string known;
  for (const std::string& n : names()) known += " " + n;
  const std::string near = nearest_name(name, names());
  throw std::invalid_argument("no sensor '" + name + "', nor such a file; " +
                              (near.empty() ? "" : "did you mean '" + near + "'? ") +
                              "known:" + known);
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const CatalogueEntry& entry : catalogue()) all.emplace_back(entry.name);
  return all;
}

}  // namespace underbrush::sensor
