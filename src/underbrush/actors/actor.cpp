#include "underbrush/actors/actor.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/mesh_file.hpp"
#include "underbrush/perception/truth.hpp"

namespace underbrush::actors {
namespace fs = std::filesystem;
namespace {

/// The extents of the box about the origin that has all elements of a model, up to a standard
/// deviation from the middle of an ellipsoid.
Vec3 size_of(const elements::Model& model) {
  Vec3 half = Vec3::Zero();
  for (const elements::TriangleMesh* mesh : {&model.ground, &model.surface}) {
    for (const Vec3f& v : mesh->vertices) half = half.cwiseMax(v.cast<double>().cwiseAbs());
  }
  for (const elements::Ellipsoid& e : model.ellipsoids) {
    const Vec3 sigma = e.covariance_matrix().diagonal().cwiseSqrt();
    half = half.cwiseMax(e.mean.cast<double>().cwiseAbs() + sigma);
  }
  return 2 * half;
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

std::vector<std::string> names_of(const std::vector<Actor>& actors) {
  std::vector<std::string> out;
  for (const Actor& a : actors) {
    if (std::ranges::find(out, a.name) == out.end()) out.push_back(a.name);
  }
  return out;
}

perception::LogTruth truth_of(const std::vector<Actor>& actors, const LogInfo& log) {
  require_data(!log.scans.empty(), "the log does not say when its scans were made");
  const std::vector<std::string> names = names_of(actors);
  std::vector<Vec3> size_m;
  size_m.reserve(actors.size());
  for (const Actor& a : actors) size_m.push_back(size_of(a.model));
  std::vector<perception::ObjectList> lists;
  for (const ScanInfo& scan : log.scans) {
    perception::TruthFrame frame{scan.time_s, {}};
    for (size_t k = 0; k < actors.size(); ++k) {
      const Actor& a = actors[k];
      if (scan.time_s < a.from_s || scan.time_s >= a.to_s) continue;
      const auto& poses = a.world_from_actor.poses();
      const Pose at = *a.world_from_actor.at(
          std::clamp(scan.time_s, poses.front().time_s, poses.back().time_s));
      const Vec3 ahead = at.rotation * Vec3::UnitX();
      const auto number = uint64_t(std::ranges::find(names, a.name) - names.begin()) + 1;
      frame.objects.push_back(
          {number,
           perception::class_of_name(a.label).value_or(perception::ObjectClass::kUnknown),
           {at.translation, std::atan2(ahead.y(), ahead.x()), size_m[k]}});
    }
    lists.push_back(perception::list_of_truth(frame, scan.world_from_sensor));
  }
  return perception::LogTruth(lists);
}

std::vector<Actor> read_actor_folder(const fs::path& folder) {
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
                   scene.models[model], mover->world_from_object, mover->from_s, mover->to_s,
                   uint32_t(i)});
  }
  return out;
}

}  // namespace underbrush::actors
