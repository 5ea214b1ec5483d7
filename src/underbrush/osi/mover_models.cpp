#include "underbrush/osi/mover_models.hpp"

#include <algorithm>
#include <filesystem>

#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/io/mesh_file.hpp"

namespace underbrush::osi {
namespace fs = std::filesystem;
namespace {

elements::Model box_model(const Vec3& size) {
  std::vector<Vec3f> v;
  v.reserve(8);
  for (int k = 0; k < 8; ++k) {
    v.emplace_back(Vec3f(k & 1 ? 0.5f : -0.5f, k & 2 ? 0.5f : -0.5f, k & 4 ? 0.5f : -0.5f)
                       .cwiseProduct(size.cast<float>()));
  }
  return mesh_model(v, {{0, 1, 3},
                        {0, 3, 2},
                        {4, 6, 7},
                        {4, 7, 5},
                        {0, 4, 5},
                        {0, 5, 1},
                        {2, 3, 7},
                        {2, 7, 6},
                        {0, 2, 6},
                        {0, 6, 4},
                        {1, 5, 7},
                        {1, 7, 3}});
}

// A mesh, moved and stretched so that it fills a box about the origin.
elements::Model fitted_mesh(elements::Model model, const Vec3& size) {
  Vec3f low = model.surface.vertices.at(0), high = low;
  for (const Vec3f& v : model.surface.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  const Vec3f extent = (high - low).cwiseMax(1e-6f),
              scale = size.cast<float>().cwiseQuotient(extent);
  for (Vec3f& v : model.surface.vertices) v = (v - (low + high) / 2).cwiseProduct(scale);
  return model;
}

}  // namespace

elements::Model mesh_model(const std::vector<Vec3f>& vertices,
                           const std::vector<std::array<uint32_t, 3>>& triangles) {
  elements::Model m;
  m.fitter = "mesh";
  m.surface.vertices = vertices;
  m.surface.triangles = triangles;
  m.surface.hit.resize(triangles.size());
  return m;
}

MoverModels::MoverModels(const std::string& folder) {
  if (folder.empty()) return;
  if (elements::is_scene(folder)) {
    read_scene(folder);
    return;
  }
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder)) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  const std::vector<std::string> meshes = io::mesh_extensions();
  for (const fs::path& path : paths) {
    if (fs::is_directory(path)) {
      fitted_[path.filename().string()].push_back({{}, elements::read_model(path)});
    } else if (std::find(meshes.begin(), meshes.end(), path.extension()) != meshes.end()) {
      const io::MeshData mesh = io::read_mesh(path);
      meshes_.emplace(path.stem().string(), mesh_model(mesh.vertices, mesh.triangles));
    }
  }
}

void MoverModels::read_scene(const std::string& folder) {
  elements::SceneInfo info;
  const elements::Scene scene = elements::read_scene(folder, &info);
  for (const elements::Mover& m : info.movers) {
    const uint32_t k = scene.instances[m.instance].model;
    for (const std::string& name :
         {info.names[k], elements::class_name(info, info.labels[m.instance])}) {
      fitted_[name].push_back({m, scene.models[k]});
    }
  }
  require_data(!fitted_.empty(), "tracer: nothing moves in the scene of actors");
}

elements::Model MoverModels::model(const MovingObject& m, double time_s) const {
  const std::string words[] = {
      fs::path(m.model_reference).stem().string(),
      std::string(perception::name(class_of(m.type, m.vehicle_type, m.base.dimension_m)))};
  for (const std::string& word : words) {
    const auto fitted = fitted_.find(word);
    if (fitted != fitted_.end()) {
      const auto now = std::ranges::find_if(
          fitted->second, [&](const Fitted& f) { return f.times.is_there(time_s); });
      return now == fitted->second.end() ? fitted->second[0].model : now->model;
    }
    const auto mesh = meshes_.find(word);
    if (mesh != meshes_.end()) return fitted_mesh(mesh->second, *m.base.dimension_m);
  }
  return box_model(*m.base.dimension_m);
}

}  // namespace underbrush::osi
