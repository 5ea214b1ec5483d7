#include "report/light_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "underbrush/pipeline/fit_json.inl"

namespace underbrush::report {
namespace {

/// The name of a sensor, with its wavelength where the catalogue or its data file has one.
std::string with_wavelength(const std::string& name, const std::string& file) {
  if (name.empty()) return "an unknown sensor";
  try {
    LogInfo info;
    info.sensor = name;
    info.sensor_file = file;
    const double wavelength_m = sensor::sensor_of_log("", info).wavelength_m;
    return wavelength_m > 0 ? fmt::format("{} ({:.0f} nm)", name, 1e9 * wavelength_m) : name;
  } catch (const std::exception&) {
    return name;
  }
}

}  // namespace

std::string text_of_light(const elements::Model& m) {
  if (!m.light.known()) return "";
  std::string text = "  light       mean reflectance";
  const char* comma = " ";
  const nlohmann::ordered_json light = pipeline::json_of_light(m);
  for (const auto& [kind, reflectance] : light["reflectance"].items()) {
    const double mean = reflectance;
    if (mean > 0) text += fmt::format("{}{:.3g} of {}", std::exchange(comma, ", "), mean, kind);
  }
  const elements::Gain& f = m.light.range;
  if (!f.at.empty()) {
    text += fmt::format("; {:.2f} of it at {:.3g} m, {:.2f} at {:.3g} m", f.gain.front(),
                        f.at.front(), f.gain.back(), f.at.back());
  }
  if (!m.light.ring.empty()) {
    const auto [least, most] = std::minmax_element(m.light.ring.begin(), m.light.ring.end());
    text += fmt::format("; channels {:.2f} to {:.2f}", *least, *most);
  }
  return text + "\n";
}

std::string intensities_in_words(std::span<const elements::Model> models, const LogInfo& asking,
                                 bool is_learnt) {
  const auto has_light = [](const elements::Model& m) { return m.light.known(); };
  const auto lit = std::find_if(models.begin(), models.end(), has_light);
  if (lit == models.end()) return "";
  if (!is_learnt) return "of the sensor and the materials; the learnt light is not used";
  std::string text =
      "learnt from a log of " + with_wavelength(lit->sensor, lit->sensor_file) + ", in its unit";
  if (lit->sensor != asking.sensor || lit->sensor_file != asking.sensor_file) {
    text += "; " + with_wavelength(asking.sensor, asking.sensor_file) +
            " is taken to answer alike, but without gains of channels";
  }
  const auto dark = std::count_if(models.begin(), models.end(), [&](const elements::Model& m) {
    return m.size() > 0 && !m.light.known();
  });
  if (dark > 0) text += fmt::format("; {} models without light answer 0", dark);
  return text;
}

}  // namespace underbrush::report
