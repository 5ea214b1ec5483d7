#include <cmath>
#include <filesystem>

#include "underbrush/sensor/angles.hpp"
#include "underbrush/sensor/catalogue.hpp"
#include "underbrush/sensor/yaml_map.inl"

namespace underbrush::sensor {
namespace {

// Reads elevations: a list, or {first, last, count} for evenly spaced ones with both ends included.
std::vector<double> read_elevations(const YamlMap& channels) {
  if (!channels.child("elevation_deg").IsMap())
    return channels.get<std::vector<double>>("elevation_deg");
  const YamlMap even = channels.map("elevation_deg", {"first", "last", "count"});
  const auto first = even.get<double>("first"), last = even.get<double>("last");
  const auto count = even.get<int>("count");
  if (count < 2 || count > 65535) even.fail("count", "must be 2 to 65535");
  std::vector<double> out(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) out[size_t(i)] = first + (last - first) * i / (count - 1);
  return out;
}

std::vector<Channel> read_channels(const YamlMap& root,
                                   std::vector<std::array<double, 2>>* windows) {
  const YamlMap map = root.map("channels", {"elevation_deg", "azimuth_deg", "time_us", "z_mm",
                                            "azimuth_from_deg", "azimuth_to_deg"});
  const std::vector<double> elevation = read_elevations(map);
  std::vector<Channel> channels(elevation.size());
  for (size_t i = 0; i < channels.size(); ++i) channels[i].elevation_rad = elevation[i] * kDegree;
  const auto values_of = [&](const char* key) {
    auto values = map.get<std::vector<double>>(key);
    if (values.size() != channels.size()) map.fail(key, "needs one value per elevation");
    return values;
  };
  const auto fill = [&](const char* key, double unit, double most, double Channel::*field) {
    if (!map.has(key)) return;
    const std::vector<double> values = values_of(key);
    for (size_t i = 0; i < values.size(); ++i) {
      if (!(std::abs(values[i]) <= most)) {
        map.fail(key, "must be within ±" + std::to_string(int(most)));
      }
      channels[i].*field = values[i] * unit;
    }
  };
  fill("azimuth_deg", kDegree, 360, &Channel::azimuth_rad);
  fill("time_us", 1e-6, 1'000'000, &Channel::time_s);
  fill("z_mm", 1e-3, 10'000, &Channel::z_m);
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

void read_rotation(const YamlMap& map, Sensor& s) {
  s.rate_hz = map.get<double>("rate_hz");
  s.firing_period_s = map.get<double>("firing_period_us") * 1e-6;
  if (!(s.rate_hz > 0)) map.fail("rate_hz", "must be positive");
  const double firings = s.firings_per_revolution();
  if (!(firings >= 1 && firings <= 1e6)) {
    map.fail("firing_period_us", "a turn has 1 to 1 000 000 firings");
  }
  s.clockwise = map.choice<bool>("rotation", {{"clockwise", true}, {"counterclockwise", false}});
  s.start_azimuth_rad = map.get("start_azimuth_deg", 180.0) * kDegree;
}

// Reads a sweep: the firings of one turn, of each channel within its own window.
void read_sweep(const YamlMap& map, Sensor& s) {
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

void read_raster(const YamlMap& root, Sensor& s) {
  const YamlMap map =
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

void read_directions(const YamlMap& map, Sensor& s) {
  s.rate_hz = map.get<double>("rate_hz");
  s.cycle_s = map.get<double>("cycle_s");
  if (!(s.cycle_s > 0)) map.fail("cycle_s", "must be positive");
  const auto name = map.get<std::string>("directions");
  for (const CatalogueEntry& entry : catalogue_tables()) {
    if (entry.name == name) s.shots = shots_from_csv(name, entry.text, s.cycle_s);
  }
  if (s.shots.empty()) {
    const auto path = (std::filesystem::path(map.file()).parent_path() / name).string();
    try {
      s.shots = shots_from_csv(path, text_of(path), s.cycle_s);
    } catch (const FormatError& e) {
      map.fail("directions", e.what());
    }
  }
  s.firing_period_s = s.cycle_s / double(s.shots.size());
  if (!(s.rate_hz > 0)) map.fail("rate_hz", "must be positive");
  if (!(s.rate_hz * s.firing_period_s >= 1e-8)) {
    map.fail("rate_hz", "a frame has at most 100 000 000 shots");
  }
}

std::vector<Prism> read_prisms(const YamlMap& map) {
  const YamlMap columns = map.map("prisms", {"rotor_hz", "angle_deg", "index"});
  const auto rotor = columns.get<std::vector<double>>("rotor_hz");
  const auto angle = columns.get<std::vector<double>>("angle_deg");
  const auto index = columns.get<std::vector<double>>("index");
  if (angle.size() != rotor.size()) columns.fail("angle_deg", "needs one value per rotor");
  if (index.size() != rotor.size()) columns.fail("index", "needs one value per rotor");
  std::vector<Prism> prisms(rotor.size());
  for (size_t i = 0; i < prisms.size(); ++i) prisms[i] = {rotor[i], angle[i] * kDegree, index[i]};
  return prisms;
}

PrismLaser read_laser(const YamlMap& map, const std::vector<Prism>& prisms) {
  PrismLaser laser;
  const auto d = map.get("direction", std::vector<double>{1, 0, 0});
  const auto q = map.get("attitude", std::vector<double>{0, 0, 0, 1});
  if (d.size() != 3) map.fail("direction", "needs x, y, z");
  if (q.size() != 4) map.fail("attitude", "needs qx, qy, qz, qw");
  laser.direction = Vec3(d[0], d[1], d[2]).normalized();
  laser.sensor_from_laser = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized();
  laser.prisms = map.has("prisms") ? read_prisms(map) : prisms;
  return laser;
}

void read_risley(const YamlMap& root, Sensor& s) {
  s.rate_hz = root.get<double>("rate_hz");
  s.risley.pulse_hz = root.get<double>("shots_per_s");
  s.risley.start_s = root.get("start_s", 0.0);
  const std::vector<Prism> prisms = read_prisms(root);
  if (root.has("lasers")) {
    if (!root.child("lasers").IsSequence()) root.fail("lasers", "needs a list");
    for (const YAML::Node& node : root.child("lasers")) {
      const YamlMap map(root.file(), "lasers", node, {"direction", "attitude", "prisms"});
      s.risley.lasers.push_back(read_laser(map, prisms));
    }
  } else {
    s.risley.lasers.push_back({Vec3::UnitX(), Eigen::Quaterniond::Identity(), prisms});
  }
  s.firing_period_s = 1 / s.beams_per_s();
  if (!(s.rate_hz > 0 && s.beams_per_s() / s.rate_hz <= 1e8)) {
    root.fail("rate_hz", "must be positive, for at most 100 000 000 shots a frame");
  }
}

}  // namespace

void read_pattern(const YamlMap& root, Sensor& s) {
  const auto kind = root.get<std::string>("kind");
  s.kind = root.choice<Kind>("kind", {{"spinning", Kind::kSpinning},
                                      {"raster", Kind::kRaster},
                                      {"sweep", Kind::kSequence},
                                      {"directions", Kind::kSequence},
                                      {"risley", Kind::kRisley}});
  if (kind == "spinning") {
    read_rotation(root, s);
    s.channels = read_channels(root, nullptr);
  } else if (kind == "sweep") {
    read_sweep(root, s);
  } else if (kind == "raster") {
    read_raster(root, s);
  } else if (kind == "risley") {
    read_risley(root, s);
  } else {
    read_directions(root, s);
  }
  s.firings_per_packet = root.get("firings_per_packet", 1);
}

}  // namespace underbrush::sensor
