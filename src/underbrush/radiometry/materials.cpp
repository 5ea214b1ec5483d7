#include "underbrush/radiometry/materials.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/leaf_angle_distribution.hpp"
#include "underbrush/core/names.hpp"
#include "underbrush/radiometry/materials_data.hpp"

namespace underbrush::radiometry {
namespace {

constexpr uint64_t kMostBytes = uint64_t(1) << 24;

/// A file that is being read; errors name it.
struct Reader {
  std::string file;

  [[noreturn]] void fail(const std::string& place, const std::string& reason) const {
    throw FormatError(file, place, reason);
  }

  void check_keys(const YAML::Node& map, const std::string& place,
                  std::initializer_list<std::string_view> keys) const {
    if (!map.IsMap()) fail(place, "expected KEY: VALUE");
    for (const auto& entry : map) {
      if (!entry.first.IsScalar()) fail(place, "expected KEY: VALUE");
      const auto key = entry.first.Scalar();
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) fail(place + key, "unknown key");
    }
  }

  template <class T>
  T get(const YAML::Node& map, const std::string& key, const std::string& place) const {
    if (!map[key]) fail(place + key, "missing");
    try {
      return map[key].as<T>();
    } catch (const YAML::Exception&) {
      fail(place + key, "not the expected kind of value");
    }
  }

  double number(const YAML::Node& map, const std::string& key, const std::string& place,
                double fallback, double low, double high) const {
    const double v = map[key] ? get<double>(map, key, place) : fallback;
    if (!(v >= low && v <= high)) fail(place + key, "out of its range");
    return v;
  }

  Material material(const std::string& name, const YAML::Node& node,
                    const std::vector<double>& wavelength_nm) const {
    const std::string place = "materials." + name + ".";
    check_keys(node, place,
               {"reflectance", "brdf", "roughness_deg", "gloss", "exponent", "leaf_shape"});
    Material m;
    m.name = name;
    const auto values = get<std::vector<double>>(node, "reflectance", place);
    if (values.size() != wavelength_nm.size()) fail(place + "reflectance", "one per wavelength");
    for (size_t k = 0; k < values.size(); ++k) {
      if (!(values[k] >= 0 && values[k] <= 1)) fail(place + "reflectance", "must be 0 to 1");
      m.reflectance.emplace_back(wavelength_nm[k] * 1e-9, values[k]);
    }
    const std::string brdf = node["brdf"] ? get<std::string>(node, "brdf", place) : "lambert";
    if (brdf == "oren_nayar") {
      m.surface.brdf = Brdf::kOrenNayar;
    } else if (brdf == "phong") {
      m.surface.brdf = Brdf::kPhong;
    } else if (brdf != "lambert") {
      fail(place + "brdf", "must be lambert, oren_nayar or phong");
    }
    m.surface.roughness_rad = number(node, "roughness_deg", place, 0, 0, 90) * M_PI / 180;
    m.surface.gloss = number(node, "gloss", place, 0, 0, 1);
    m.surface.exponent = number(node, "exponent", place, 20, 0, 1e6);
    m.leaf_shape = number(node, "leaf_shape", place, 1, 0.01, 100);
    return m;
  }

  Materials materials(const YAML::Node& root) const {
    check_keys(root, "", {"wavelength_nm", "materials", "classes", "sources"});
    const auto wavelength_nm = get<std::vector<double>>(root, "wavelength_nm", "");
    if (wavelength_nm.empty() || !(wavelength_nm.front() > 0) ||
        std::adjacent_find(wavelength_nm.begin(), wavelength_nm.end(),
                           [](double a, double b) { return !(a < b); }) != wavelength_nm.end()) {
      fail("wavelength_nm", "must rise");
    }
    Materials all;
    if (!root["materials"] || !root["materials"].IsMap()) fail("materials", "expected NAME: {...}");
    for (const auto& entry : root["materials"]) {
      if (!entry.first.IsScalar()) fail("materials", "expected NAME: {...}");
      all.material.push_back(material(entry.first.as<std::string>(), entry.second, wavelength_nm));
    }
    if (!root["classes"] || !root["classes"].IsMap()) fail("classes", "expected CLASS: MATERIAL");
    for (const auto& entry : root["classes"]) {
      if (!entry.first.IsScalar() || !entry.second.IsScalar()) {
        fail("classes", "expected CLASS: MATERIAL");
      }
      all.of_class.emplace_back(entry.first.as<std::string>(), entry.second.as<std::string>());
      try {
        all.named(all.of_class.back().second);
      } catch (const std::invalid_argument& e) {
        fail("classes." + all.of_class.back().first, e.what());
      }
    }
    const auto is_unknown = [](const auto& entry) { return entry.first == "unknown"; };
    if (std::none_of(all.of_class.begin(), all.of_class.end(), is_unknown)) {
      fail("classes", "the class 'unknown' is missing, which stands for all that are not named");
    }
    if (root["sources"]) all.sources = get<std::vector<std::string>>(root, "sources", "");
    return all;
  }
};

}  // namespace

double Material::reflectance_at(double wavelength_m) const {
  require(!reflectance.empty(), "material: no reflectance");
  if (wavelength_m <= reflectance.front().first) return reflectance.front().second;
  for (size_t k = 1; k < reflectance.size(); ++k) {
    const auto& [a, low] = reflectance[k - 1];
    const auto& [b, high] = reflectance[k];
    if (wavelength_m <= b) return low + (high - low) * (wavelength_m - a) / (b - a);
  }
  return reflectance.back().second;
}

const Material& Materials::named(std::string_view name) const {
  std::vector<std::string> known;
  for (const Material& m : material) {
    if (m.name == name) return m;
    known.push_back(m.name);
  }
  const std::string near = nearest_name(name, known);
  throw std::invalid_argument("no material '" + std::string(name) + "'" +
                              (near.empty() ? "" : "; did you mean '" + near + "'?"));
}

const Material& Materials::of(std::string_view class_name) const {
  for (const std::string_view wanted : {class_name, std::string_view("unknown")}) {
    for (const auto& [name, made_of] : of_class) {
      if (name == wanted) return named(made_of);
    }
  }
  throw std::invalid_argument("materials: no material for class '" + std::string(class_name) +
                              "', nor for 'unknown'");
}

Materials load_materials(std::string_view path) {
  const Reader reader{path.empty() ? "materials.yaml" : std::string(path)};
  const std::string text =
      path.empty() ? std::string(materials_yaml()) : read_file(reader.file, kMostBytes);
  try {
    return reader.materials(YAML::Load(text));
  } catch (const YAML::Exception& e) {
    reader.fail("line " + std::to_string(e.mark.line + 1), e.msg);
  }
}

}  // namespace underbrush::radiometry
