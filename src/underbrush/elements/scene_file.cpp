#include "underbrush/elements/scene_file.hpp"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/io/ply.hpp"
#include "underbrush/io/poses.hpp"

namespace underbrush::elements {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

std::string folder_of(size_t model) {
  char name[32];
  std::snprintf(name, sizeof name, "models/%04zu", model);
  return name;
}

std::string trajectory_file(size_t mover) {
  char name[32];
  std::snprintf(name, sizeof name, "movers/%04zu.txt", mover);
  return name;
}

void write_movers(const fs::path& folder, const std::vector<Mover>& movers) {
  if (!movers.empty()) make_temporary_folders(folder / "movers");
  for (size_t k = 0; k < movers.size(); ++k) {
    std::ofstream out(folder / trajectory_file(k));
    out.precision(17);
    out << "# world from object: time x y z qx qy qz qw\n";
    for (const StampedPose& p : movers[k].world_from_object.poses()) {
      const Pose& pose = p.world_from_sensor;
      out << p.time_s << " " << pose.translation.transpose() << " "
          << pose.rotation.coeffs().transpose() << "\n";
    }
    if (!out.flush()) throw IoError((folder / trajectory_file(k)).string() + ": cannot write");
  }
}

Mover read_mover(const io::JsonValue& j, size_t instances) {
  j.check_members({"instance", "trajectory", "from_s", "to_s"});
  Mover mover;
  mover.instance = uint32_t(j.at("instance").count(UINT32_MAX));
  if (mover.instance >= instances) j.at("instance").fail("there is no such instance");
  mover.world_from_object = io::read_trajectory(j.at("trajectory").path());
  if (const auto from = j.find("from_s")) mover.from_s = from->number();
  if (const auto to = j.find("to_s")) mover.to_s = to->number();
  return mover;
}

Json json_of(const Mover& mover, size_t number) {
  Json j{{"instance", mover.instance}, {"trajectory", trajectory_file(number)}};
  if (std::isfinite(mover.from_s)) j["from_s"] = mover.from_s;
  if (std::isfinite(mover.to_s)) j["to_s"] = mover.to_s;
  return j;
}

constexpr const char* kNumbers[] = {"x", "y", "z", "qx", "qy", "qz", "qw"};

Json json_of(const SceneMaterial& m) {
  Json j;
  j["name"] = m.name;
  for (const auto& [wavelength_m, share] : m.reflectance) {
    j["wavelength_nm"].push_back(wavelength_m * 1e9);
    j["reflectance"].push_back(share);
  }
  return j;
}

SceneMaterial read_material(const io::JsonValue& j) {
  j.check_members({"name", "wavelength_nm", "reflectance"});
  SceneMaterial m{j.at("name").text(), {}};
  const std::vector<double> wavelength = j.at("wavelength_nm").numbers();
  const std::vector<double> share = j.at("reflectance").numbers();
  if (share.size() != wavelength.size() || share.empty()) {
    j.at("reflectance").fail("there must be one for each of wavelength_nm");
  }
  for (size_t k = 0; k < share.size(); ++k) {
    if (!(share[k] >= 0 && share[k] <= 1)) j.at("reflectance").fail("must be 0 to 1");
    if (wavelength[k] < 0 || (k > 0 && wavelength[k] <= wavelength[k - 1])) {
      j.at("wavelength_nm").fail("must rise");
    }
    m.reflectance.emplace_back(wavelength[k] * 1e-9, share[k]);
  }
  return m;
}

void read_classes(const io::JsonValue& j, SceneInfo& info) {
  for (const io::JsonValue& name : j.values()) {
    const size_t known = info.class_names.size();
    const std::string text = name.text();
    class_named(info, text);
    if (info.class_names.size() == known) {
      name.fail(text.empty() ? "a class without a name" : "a class that there is already");
    }
  }
}

}  // namespace

void write_instances(const fs::path& path, std::span<const Instance> instances,
                     std::span<const Class> labels) {
  io::PlyElement e;
  e.name = "vertex";
  e.count = instances.size();
  for (int k = 0; k < 7; ++k) {
    std::vector<double> column;
    for (const Instance& i : instances) {
      const Pose& p = i.world_from_model;
      column.push_back(k < 3 ? p.translation[k] : p.rotation.coeffs()[k - 3]);
    }
    e.columns.emplace_back(kNumbers[k], std::move(column));
  }
  std::vector<float> scale;
  std::vector<uint32_t> model;
  std::vector<uint8_t> label;
  for (const Instance& i : instances) {
    scale.push_back(i.scale);
    model.push_back(i.model);
  }
  for (const Class c : labels) label.push_back(uint8_t(c));
  e.columns.emplace_back("scale", std::move(scale));
  e.columns.emplace_back("model", std::move(model));
  e.columns.emplace_back("class", std::move(label));
  io::PlyData data;
  data.elements = {std::move(e)};
  io::write_ply(path, data);
}

void read_instances(const fs::path& file, Scene& scene, SceneInfo& info) {
  const io::PlyData data = io::read_ply(file);
  const io::PlyElement& e = io::element_of(file, data, "vertex");
  const std::vector<double>* numbers[7];
  for (int k = 0; k < 7; ++k) numbers[k] = &io::column_of<double>(file, e, kNumbers[k]);
  const auto& scale = io::column_of<float>(file, e, "scale");
  const auto& model = io::column_of<uint32_t>(file, e, "model");
  const auto& label = io::column_of<uint8_t>(file, e, "class");
  for (size_t i = 0; i < e.count; ++i) {
    Instance& instance = scene.instances.emplace_back();
    for (int k = 0; k < 7; ++k) {
      double& to = k < 3 ? instance.world_from_model.translation[k]
                         : instance.world_from_model.rotation.coeffs()[k - 3];
      to = (*numbers[k])[i];
    }
    instance.scale = scale[i];
    instance.model = model[i];
    if (label[i] >= kClassNames.size() + info.class_names.size()) {
      throw FormatError(file.string(), "row " + std::to_string(i + 1), "an unknown class");
    }
    info.labels.push_back(Class(label[i]));
  }
}

std::string class_name(const SceneInfo& info, Class c) {
  const size_t number = size_t(c);
  return number < kClassNames.size() ? std::string(kClassNames[number])
                                     : info.class_names.at(number - kClassNames.size());
}

Class class_named(SceneInfo& info, std::string_view name) {
  constexpr size_t kLongest = 64;  // bytes
  const std::string shown = printable(name, kLongest);
  name = shown;
  if (name.empty()) return Class::kUnknown;
  if (const auto known = class_from_name(name)) return *known;
  size_t k = 0;
  while (k < info.class_names.size() && info.class_names[k] != name) ++k;
  if (k == info.class_names.size()) {
    if (kClassNames.size() + k > UINT8_MAX) return Class::kUnknown;
    info.class_names.emplace_back(name);
  }
  return Class(kClassNames.size() + k);
}

std::vector<std::string> element_classes(const SceneInfo& info) {
  std::vector<std::string> names;
  if (info.class_names.empty()) return names;
  names.assign(kClassNames.begin(), kClassNames.end());
  names.insert(names.end(), info.class_names.begin(), info.class_names.end());
  return names;
}

bool is_scene(const fs::path& path) { return fs::is_regular_file(path / "scene.json"); }

void check_scene_output(const fs::path& path) {
  io::check_output_folder(path, is_scene(path), "not a scene");
}

void write_scene(const fs::path& path, const Scene& scene, const SceneInfo& info) {
  scene.check();
  require(info.names.size() == scene.models.size() && info.labels.size() == scene.instances.size(),
          "scene: one name a model and one class an instance are needed");
  require(info.materials.empty() || info.materials.size() == scene.models.size(),
          "scene: one material a model is needed");
  check_scene_output(path);
  Json j;
  j["format"] = "underbrush-scene";
  j["version"] = kSceneVersion;
  j["models"] = Json::array();
  for (size_t k = 0; k < scene.models.size(); ++k) {
    j["models"].push_back({{"folder", folder_of(k)}, {"name", info.names[k]}});
    if (!info.materials.empty() && !info.materials[k].empty()) {
      j["models"].back()["material"] = info.materials[k];
    }
  }
  if (!info.class_names.empty()) j["classes"] = info.class_names;
  for (const SceneMaterial& m : info.own_materials) j["materials"].push_back(json_of(m));
  j["instances"] = {{"file", "instances.ply"}, {"count", scene.instances.size()}};
  for (size_t k = 0; k < info.movers.size(); ++k) {
    j["movers"].push_back(json_of(info.movers[k], k));
  }
  j["provenance"] = info.provenance.empty() ? Json::object() : io::json_of_text(info.provenance);
  io::write_atomically(
      path,
      [&](const fs::path& folder) {
        make_temporary_folders(folder / "models");
        for (size_t k = 0; k < scene.models.size(); ++k) {
          write_model(folder / folder_of(k), scene.models[k]);
        }
        write_instances(folder / "instances.ply", scene.instances, info.labels);
        write_movers(folder, info.movers);
        write_file(folder / "scene.json", io::text_of_json(j, 1) + "\n");
      },
      io::OutputKind::kFolder);
}

Scene read_scene(const fs::path& path, SceneInfo* info) {
  const fs::path file = path / "scene.json";
  if (!is_scene(path)) throw FormatError(path.string(), "", "not a scene (no scene.json in it)");
  const io::JsonFile json(file);
  const io::JsonValue j = json.manifest("underbrush-scene", kSceneVersion, "an underbrush scene");
  j.check_members({"$schema", "format", "version", "comment", "models", "classes", "materials",
                   "instances", "movers", "provenance"});
  Scene scene;
  SceneInfo read;
  for (const io::JsonValue& m : j.at("models").values()) {
    m.check_members({"folder", "name", "material"});
    const auto material = m.find("material");
    read.names.push_back(m.at("name").text());
    read.materials.push_back(material ? material->text() : "");
    scene.models.push_back(read_model(m.at("folder").path()));
  }
  if (const auto classes = j.find("classes")) read_classes(*classes, read);
  if (const auto materials = j.find("materials")) {
    for (const io::JsonValue& m : materials->values()) {
      read.own_materials.push_back(read_material(m));
    }
  }
  read.provenance = j.at("provenance").dump();
  const io::JsonValue instances = j.at("instances");
  instances.check_members({"file", "count"});
  read_instances(instances.at("file").path(), scene, read);
  if (scene.instances.size() != instances.at("count").count()) {
    throw FormatError(file.string(), "", "its counts and its files disagree");
  }
  try {
    scene.check();
  } catch (const std::invalid_argument& e) {
    throw FormatError(path.string(), "", e.what());
  }
  if (const auto movers = j.find("movers")) {
    for (const io::JsonValue& m : movers->values()) {
      read.movers.push_back(read_mover(m, scene.instances.size()));
    }
  }
  if (info) *info = std::move(read);
  return scene;
}

}  // namespace underbrush::elements
