#include <filesystem>

#include "underbrush/core/file.hpp"
#include "underbrush/core/names.hpp"
#include "underbrush/sensor/catalogue.hpp"
#include "underbrush/sensor/yaml_map.inl"

namespace underbrush::sensor {
namespace {

constexpr uint64_t kMostBytes = uint64_t(1) << 28;

void read_beam(const YamlMap& map, Sensor& s) {
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
  for (const double lines : sub_rays) {
    if (!(lines >= 1 && lines <= kMostSubRayLines)) map.fail("sub_rays", "must be 1 to 1024");
  }
  s.sub_rays = {int(sub_rays[0]), int(sub_rays[1])};
  s.wavelength_m = map.get("wavelength_nm", 0.0) * 1e-9;
}

void read_receiver(const YamlMap& root, SignalChain& c) {
  if (!root.has("receiver")) return;
  const YamlMap map =
      root.map("receiver",
               {"pulse", "pulse_ns", "response_ns", "sample_ns", "timing", "threshold_snr",
                "detects", "min_gap_m", "saturation_snr", "adc_step_snr", "returns", "max_echoes",
                "intensity", "intensity_scale", "intensity_step", "intensity_max", "width_step_m"});
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
    const YamlMap detects = map.map("detects", {"range_m", "reflectance"});
    c.detection_range_m = detects.get<double>("range_m");
    c.detection_reflectance = detects.get<double>("reflectance");
  }
  c.min_gap_m = map.get("min_gap_m", c.min_gap_m);
  c.saturation_snr = map.get("saturation_snr", c.saturation_snr);
  c.adc_step_snr = map.get("adc_step_snr", c.adc_step_snr);
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
  const YamlMap map(file, "", root,
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
                     "start_s",
                     "prisms",
                     "lasers",
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
  read_pattern(map, s);
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

std::string text_of(const std::string& path) { return read_file(path, kMostBytes); }

Sensor load(std::string_view name_or_yaml_path) {
  const std::string name(name_or_yaml_path);
  for (const CatalogueEntry& entry : catalogue()) {
    if (entry.name == name) return parse(name, std::string(entry.text));
  }
  if (is_file(name)) {
    const std::string text = text_of(name);
    Sensor s = parse(name, text);
    s.file = text;
    return s;
  }
  std::string known;
  for (const std::string& n : names()) known += " " + n;
  const std::string near = nearest_name(name, names());
  throw std::invalid_argument("no sensor '" + name + "', nor such a file; " +
                              (near.empty() ? "" : "did you mean '" + near + "'? ") +
                              "known:" + known);
}

Sensor sensor_of_log(const std::string& log, const LogInfo& info) {
  if (info.sensor.empty()) throw FormatError(log, "", "does not name its sensor");
  if (info.sensor_file.empty()) return load(info.sensor);
  Sensor s = parse(log + ": sensor " + info.sensor, info.sensor_file);
  s.file = info.sensor_file;
  return s;
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const CatalogueEntry& entry : catalogue()) all.emplace_back(entry.name);
  return all;
}

}  // namespace underbrush::sensor
