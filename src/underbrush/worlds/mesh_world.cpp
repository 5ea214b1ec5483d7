#include "underbrush/worlds/mesh_world.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/mesh_file.hpp"
#include "underbrush/io/ply_header.hpp"

namespace underbrush::worlds {
namespace fs = std::filesystem;
namespace {

using elements::Class;

const io::MeshMaterial* material_named(const io::MeshScene& mesh, const std::string& name) {
  for (const io::MeshMaterial& m : mesh.materials) {
    if (m.name == name) return &m;
  }
  return nullptr;
}

Class class_of(World& world, const io::MeshPart& part, const io::MeshMaterial* material) {
  if (const auto known = elements::class_from_name(part.object)) return *known;
  if (material && material->classification && *material->classification > 0) {
    const int number = *material->classification;
    return number == 2 ? Class::kGround
                       : elements::class_named(world.info, "las_" + std::to_string(number));
  }
  return elements::class_named(world.info, part.material.empty() ? part.object : part.material);
}

/// Makes the material of the file one of the scene and returns its name; empty where the file does
/// not state its reflectance.
std::string own_material(World& world, const io::MeshMaterial* material) {
  if (!material || material->reflectance.empty()) return "";
  const elements::SceneMaterial own{material->name, material->reflectance};
  for (const elements::SceneMaterial& m : world.info.own_materials) {
    if (m.name == own.name && m.reflectance == own.reflectance) return own.name;
  }
  elements::SceneMaterial added = own;
  const auto taken = [&](const elements::SceneMaterial& m) { return m.name == added.name; };
  for (size_t k = 2;
       std::any_of(world.info.own_materials.begin(), world.info.own_materials.end(), taken); ++k) {
    added.name = own.name + "_" + std::to_string(k);
  }
  world.info.own_materials.push_back(added);
  return added.name;
}

/// Adds a model without elements.
void add_model(World& world, const io::MeshScene& mesh, const io::MeshPart& part,
               PartModels& models) {
  const io::MeshMaterial* material = material_named(mesh, part.material);
  models.model.push_back(uint32_t(world.scene.models.size()));
  models.label.push_back(class_of(world, part, material));
  world.info.materials.push_back(own_material(world, material));
  std::string name = part.object;
  if (!part.material.empty()) name += (name.empty() ? "" : " / ") + part.material;
  world.info.names.push_back(printable(name));
  world.scene.models.emplace_back().fitter = "mesh";
}

bool has_faces(const fs::path& path) try {
  const io::PlyHeader header = io::read_ply_header(InputFile(path));
  return std::any_of(header.elements.begin(), header.elements.end(), [](const auto& e) {
    return (e.name == "face" || e.name == "tristrips") &&
           e.count > 0;  // The reader refuses strips.
  });
} catch (const FormatError&) {
  return false;
}

}  // namespace

Vec3 offset_of(const Vec3& low, const Vec3& high) {
  constexpr double kNear = 256;  // m; single precision has steps of 15 to 31 µm there.
  if (std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff()) <= kNear) {
    return Vec3::Zero();
  }
  return (0.5 * (low + high)).array().round();
}

World empty_world(const Vec3& offset) {
  World world;
  world.report.offset_m = offset;
  world.scene.models.emplace_back().fitter = "mesh";
  world.scene.instances.emplace_back().world_from_model.translation = offset;
  world.info.names.emplace_back("nothing");
  world.info.labels.push_back(Class::kUnknown);
  world.info.materials.emplace_back();
  return world;
}

PartModels add_models(World& world, const io::MeshScene& mesh, const std::vector<Vec3>& vertices,
                      const Vec3& offset) {
  PartModels models;
  for (const io::MeshPart& part : mesh.parts) add_model(world, mesh, part, models);
  std::vector<std::vector<uint32_t>> of_part(mesh.parts.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t) of_part[mesh.part[t]].push_back(uint32_t(t));
  constexpr uint32_t kNone = UINT32_MAX;
  std::vector<uint32_t> number(vertices.size(), kNone);
  for (size_t k = 0; k < of_part.size(); ++k) {
    elements::Model& model = world.scene.models[models.model[k]];
    elements::TriangleMesh& to = models.label[k] == Class::kGround ? model.ground : model.surface;
    std::vector<uint32_t> used;
    for (const uint32_t t : of_part[k]) {
      std::array<uint32_t, 3> corner{};
      for (size_t c = 0; c < 3; ++c) {
        const uint32_t v = mesh.triangles[t][c];
        if (number[v] == kNone) {
          number[v] = uint32_t(to.vertices.size());
          used.push_back(v);
          const Vec3 relative = vertices[v] - offset;
          to.vertices.push_back(relative.cast<float>());
          const Vec3 change = to.vertices.back().cast<double>() - relative;
          world.report.rounding_m = std::max(world.report.rounding_m, change.cwiseAbs().maxCoeff());
        }
        corner[c] = number[v];
      }
      to.triangles.push_back(corner);
    }
    to.hit.resize(to.triangles.size());
    for (const uint32_t v : used) number[v] = kNone;
  }
  for (const auto& [what, n] : mesh.left_out) world.report.left_out[what] += n;
  return models;
}

void place(World& world, const PartModels& models, const elements::Instance& placed) {
  for (size_t k = 0; k < models.model.size(); ++k) {
    elements::Instance& instance = world.scene.instances.emplace_back(placed);
    instance.model = models.model[k];
    world.info.labels.push_back(models.label[k]);
    ++world.report.parts;
    world.report.triangles += world.scene.models[instance.model].triangle_count();
    world.report.without_material += world.info.materials[instance.model].empty();
  }
}

bool is_mesh(const fs::path& path) {
  if (!is_file(path)) return false;
  std::string e = path.extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return std::tolower(c); });
  if (e == ".ply") return has_faces(path);
  const std::vector<std::string> known = io::mesh_scene_extensions();
  return std::find(known.begin(), known.end(), e) != known.end();
}

World read_mesh_world(const fs::path& path, const MeshOptions& options) {
  const io::MeshScene mesh = io::read_mesh_scene(path);
  const bool y_up = options.up == "y" || io::is_gltf(path);
  std::vector<Vec3> vertices = mesh.vertices;
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (Vec3& v : vertices) {
    if (y_up) v = Vec3(v.x(), -v.z(), v.y());
    v *= options.unit_m;
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  World world = empty_world(offset_of(low, high));
  world.report.unit_m = options.unit_m;
  world.report.y_up = y_up;
  elements::Instance placed;
  placed.world_from_model.translation = world.report.offset_m;
  place(world, add_models(world, mesh, vertices, world.report.offset_m), placed);
  return world;
}

}  // namespace underbrush::worlds
