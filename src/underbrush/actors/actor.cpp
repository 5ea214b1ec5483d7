#include "underbrush/actors/actor.hpp"

#include <algorithm>

#include "underbrush/actors/actor_edits.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/mesh_file.hpp"

namespace underbrush::actors {
namespace fs = std::filesystem;
namespace {

std::vector<Actor> read_scene_of_actors(const fs::path& folder) {
  elements::SceneInfo info;
  elements::Scene scene = elements::read_scene(folder, &info);
  std::vector<Actor> out;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const auto mover = std::ranges::find(info.movers, i, &elements::Mover::instance);
    if (mover == info.movers.end()) {
      throw FormatError(folder.string(), "", "these are no actors: an instance does not move");
    }
    const uint32_t model = scene.instances[i].model;
    out.push_back({info.names[model], elements::class_name(info, info.labels[i]),
                   scene.models[model], mover->world_from_object, mover->from_s, mover->to_s});
  }
  return out;
}

}  // namespace

elements::Model read_mover(const fs::path& path) {
  if (fs::is_directory(path)) return elements::read_model(path);
  const io::MeshData mesh = io::read_mesh(path);
  elements::Model model;
  model.fitter = "mesh";
  model.surface.vertices = mesh.vertices;
  model.surface.triangles = mesh.triangles;
  model.surface.hit.resize(mesh.triangles.size());
  return model;
}

elements::Model at_zero(elements::Model model) {
  const Vec3f by = model.origin.cast<float>();
  for (elements::TriangleMesh* mesh : {&model.ground, &model.surface}) {
    for (Vec3f& v : mesh->vertices) v += by;
  }
  for (elements::Ellipsoid& e : model.ellipsoids) e.mean += by;
  model.origin.setZero();
  model.keyframes.reset();
  model.observed.reset();
  return model;
}

void write_actors(const fs::path& folder, const std::vector<Actor>& actors,
                  const std::string& provenance) {
  elements::Scene scene;
  elements::SceneInfo info;
  for (const Actor& a : actors) {
    const auto number = uint32_t(scene.models.size());
    scene.models.push_back(a.model);
    scene.instances.push_back({Pose{}, 1, number});
    info.names.push_back(a.name);
    info.labels.push_back(elements::class_named(info, a.label));
    info.movers.push_back({number, a.world_from_actor, a.from_s, a.to_s});
  }
  info.provenance = provenance;
  elements::write_scene(folder, scene, info);
}

std::vector<Actor> read_actors(const fs::path& path) {
  return fs::is_directory(path) ? read_scene_of_actors(path) : read_edited_actors(path);
}

}  // namespace underbrush::actors
