#include "underbrush/elements/model_file.hpp"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/elements/element_tables.hpp"
#include "underbrush/elements/keyframes_file.hpp"
#include "underbrush/elements/light_json.inl"
#include "underbrush/elements/observed_space_file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/io/ply.hpp"

namespace underbrush::elements {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

double number_or(const io::JsonValue& object, const char* member, double otherwise) {
  const auto found = object.find(member);
  return found ? found->number() : otherwise;
}

TriangleMesh read_mesh(const io::JsonValue& manifest) {
  TriangleMesh mesh = read_mesh_table(manifest.at("file").path());
  mesh.range_sigma_m = manifest.at("range_sigma_m").number();
  mesh.roughness_m = number_or(manifest, "roughness_m", 0);
  return mesh;
}

Json manifest_of_mesh(const TriangleMesh& mesh, const char* file) {
  Json j{{"file", file}, {"triangles", mesh.size()}, {"range_sigma_m", mesh.range_sigma_m}};
  if (mesh.roughness_m > 0) j["roughness_m"] = mesh.roughness_m;
  return j;
}

Json json_of_grain(const Model& m) {
  Json j{{"ellipsoids", m.grain.ellipsoid_m}, {"meshes", m.grain.mesh_m}};
  for (const ClassGrain& c : m.grain.classes) j["classes"][m.class_name(c.label)] = c.side_m;
  return j;
}

/// Reads the grain of a model whose class names are known.
Grain grain_of_json(const io::JsonValue& j, const Model& m) {
  Grain grain{j.at("ellipsoids").number(), j.at("meshes").number(), {}};
  const auto classes = j.find("classes");
  if (!classes) return grain;
  for (const std::string& name : classes->member_names()) {
    const auto label = m.class_number(name);
    if (!label) classes->at(name.c_str()).fail("not a class of the model");
    grain.classes.push_back({*label, classes->at(name.c_str()).number()});
  }
  return grain;
}

Json json_of_channels(const ChannelOffsets& channels) {
  Json j = Json::array();
  for (const ChannelOffset& c : channels) {
    j.push_back({{"ring", c.ring},
                 {"range_offset_m", c.range_m},
                 {"standard_error_m", c.standard_error_m}});
  }
  return j;
}

ChannelOffsets channels_of_json(const io::JsonValue& j) {
  ChannelOffsets channels;
  for (const io::JsonValue& c : j.values()) {
    const uint64_t ring = c.at("ring").count();
    if (ring > UINT16_MAX) c.at("ring").fail("not a ring");
    channels.push_back(
        {uint16_t(ring), c.at("range_offset_m").number(), c.at("standard_error_m").number()});
  }
  return channels;
}

Json manifest_of(const Model& m) {
  Json j;
  j["format"] = "underbrush-model";
  j["version"] = kModelVersion;
  j["fitter"] = m.fitter;
  j["origin_m"] = {m.origin.x(), m.origin.y(), m.origin.z()};
  j["tau"] = m.tau;
  if (m.voxel_m > 0) j["voxel_m"] = m.voxel_m;
  if (std::isfinite(m.max_range_m)) j["max_range_m"] = m.max_range_m;
  j["grain_m"] = json_of_grain(m);
  if (m.light.known()) j["light"] = json_of_light(m.light);
  if (!m.class_names.empty()) j["class_names"] = m.class_names;
  j["range_noise_m"] = m.range_noise_m;
  if (m.sway_s > 0) j["sway_s"] = m.sway_s;
  if (!m.leaf_angles.spherical()) j["leaf_angles"] = {{"shape", m.leaf_angles.shape()}};
  if (!m.sensor.empty()) j["sensor"] = m.sensor;
  if (!m.sensor_file.empty()) j["sensor_file"] = m.sensor_file;
  if (!m.channels.empty()) j["channels"] = json_of_channels(m.channels);
  if (m.all_echoes) j["all_echoes"] = true;
  if (m.keyframes) j["keyframes"] = Json::parse(manifest_of_keyframes(*m.keyframes));
  if (m.observed) j["observed_space"] = Json::parse(manifest_of_observed_space(*m.observed));
  j["ground"] = manifest_of_mesh(m.ground, "ground.ply");
  j["surface"] = manifest_of_mesh(m.surface, "surface.ply");
  j["ellipsoids"] = {{"file", "ellipsoids.ply"}, {"count", m.ellipsoids.size()}};
  j["provenance"] = m.provenance.empty() ? Json::object() : io::json_of_text(m.provenance);
  return j;
}

}  // namespace

bool is_model(const fs::path& path) { return fs::is_regular_file(path / "model.json"); }

void check_model_output(const fs::path& path) {
  io::check_output_folder(path, is_model(path), "not a model");
}

void write_model(const fs::path& path, const Model& model,
                 const std::function<void(const fs::path&)>& besides) {
  model.check();
  check_model_output(path);
  io::write_atomically(
      path,
      [&](const fs::path& folder) {
        make_temporary_folders(folder);
        io::write_ply(folder / "ground.ply", ply_of_mesh(model.ground, true));
        io::write_ply(folder / "surface.ply", ply_of_mesh(model.surface, true));
        io::write_ply(folder / "ellipsoids.ply",
                      ply_of_ellipsoids(model.ellipsoids, model.light.known()));
        if (model.keyframes) write_keyframes(folder, *model.keyframes);
        if (model.observed) write_observed_space(folder, *model.observed);
        write_file(folder / "model.json", io::text_of_json(manifest_of(model), 2) + "\n");
        if (besides) besides(folder);
      },
      io::OutputKind::kFolder);
}

Model read_model(const fs::path& path) {
  const fs::path file = path / "model.json";
  if (!fs::exists(path)) throw FormatError(path.string(), "", "no such model");
  if (!is_model(path)) {
    const bool is_log = is_file(path);
    throw FormatError(
        path.string(), "",
        is_log ? "not a model but a file: 'underbrush fit LOG -o MODEL' makes a model of "
                 "a log"
               : "not a model (no model.json in it)");
  }
  const io::JsonFile json(file);
  const io::JsonValue j = json.manifest("underbrush-model", kModelVersion, "an underbrush model");
  Model model;
  model.origin = j.at("origin_m").vector();
  model.tau = j.at("tau").number();
  model.voxel_m = number_or(j, "voxel_m", 0);
  model.max_range_m = number_or(j, "max_range_m", model.max_range_m);
  if (const auto names = j.find("class_names")) {
    for (const io::JsonValue& name : names->values()) model.class_names.push_back(name.text());
  }
  if (const auto grain = j.find("grain_m")) model.grain = grain_of_json(*grain, model);
  if (const auto light = j.find("light")) model.light = light_of_json(*light);
  model.range_noise_m = number_or(j, "range_noise_m", 0);
  model.sway_s = number_or(j, "sway_s", 0);
  if (const auto leaves = j.find("leaf_angles")) {
    model.leaf_angles = LeafAngleDistribution(leaves->at("shape").number());
  }
  if (const auto sensor = j.find("sensor")) model.sensor = sensor->text();
  if (const auto text = j.find("sensor_file")) model.sensor_file = text->text();
  if (const auto channels = j.find("channels")) model.channels = channels_of_json(*channels);
  if (const auto all = j.find("all_echoes")) model.all_echoes = all->boolean();
  if (const auto keyframes = j.find("keyframes")) model.keyframes = read_keyframes(*keyframes);
  if (const auto observed = j.find("observed_space")) {
    model.observed = read_observed_space(*observed);
  }
  model.fitter = j.at("fitter").text();
  model.provenance = j.at("provenance").dump();
  const io::JsonValue ground = j.at("ground"), surface = j.at("surface"),
                      ellipsoids = j.at("ellipsoids");
  model.ground = read_mesh(ground);
  model.surface = read_mesh(surface);
  model.ellipsoids = read_ellipsoid_table(ellipsoids.at("file").path());
  if (model.ground.size() != ground.at("triangles").count() ||
      model.surface.size() != surface.at("triangles").count() ||
      model.ellipsoids.size() != ellipsoids.at("count").count()) {
    throw FormatError(file.string(), "", "its counts and its files disagree");
  }
  try {
    model.check();
  } catch (const std::invalid_argument& e) {
    throw FormatError(path.string(), "", e.what());
  }
  return model;
}

void write_mesh(const fs::path& path, const TriangleMesh& mesh) {
  if (path.extension() != ".obj") {
    io::PlyData data = ply_of_mesh(mesh, false);
    data.comments = {"Underbrush"};
    return io::write_ply(path, data);
  }
  io::write_atomically(path, [&](const fs::path& temporary) {
    std::ofstream out(temporary);
    out.precision(9);
    out << "# Underbrush\n";
    for (const Vec3f& v : mesh.vertices) {
      out << "v " << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
    }
    for (const auto& t : mesh.triangles) {
      out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
    }
    if (!out.flush()) throw IoError(path.string() + ": cannot write");
  });
}

}  // namespace underbrush::elements
