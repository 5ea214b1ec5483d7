#include "underbrush/pipeline/plants.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/io/mesh_file.hpp"
#include "underbrush/test_site/prototypes.hpp"

namespace underbrush::pipeline {
namespace fs = std::filesystem;
namespace {

plant_meshes::PlantSource read_plant(const fs::path& file, const worlds::MeshOptions& o) {
  io::MeshData mesh = io::read_mesh(file);
  plant_meshes::PlantSource plant{file.string(), {}, std::move(mesh.triangles)};
  for (const Vec3f& v : mesh.vertices) {
    const Vec3f up = o.up == "y" || io::is_gltf(file) ? Vec3f(v.x(), -v.z(), v.y()) : v;
    plant.vertices.push_back(float(o.unit_m) * up);
  }
  const auto [low, high] =
      std::minmax_element(plant.vertices.begin(), plant.vertices.end(),
                          [](const Vec3f& a, const Vec3f& b) { return a.z() < b.z(); });
  if (!(high->z() - low->z() > 1e-5f)) throw FormatError(file.string(), "", "it has no height");
  const std::string folder = fs::absolute(file).parent_path().filename().string();
  const auto label = elements::class_from_name(folder);
  if (label && elements::kind_of(*label) != elements::ClassKind::kOther) plant.label = label;
  return plant;
}

}  // namespace

std::vector<plant_meshes::PlantSource> generated_plants(uint64_t seed, double variation) {
  test_site::PrototypeSet set = test_site::make_prototypes(seed, variation);
  std::vector<plant_meshes::PlantSource> plants;
  for (const test_site::PrototypeRange& range : {set.trees, set.shrubs, set.tussocks}) {
    for (uint32_t k = range.begin; k < range.end; ++k) {
      test_site::Prototype& p = set.prototypes[k];
      plants.push_back(
          {p.name, std::move(p.plant.mesh.vertices), std::move(p.plant.mesh.triangles)});
    }
  }
  return plants;
}

std::vector<plant_meshes::PlantSource> plants_of_files(const fs::path& path,
                                                       const worlds::MeshOptions& o) {
  if (!fs::exists(path)) throw FormatError(path.string(), "", "no such file or folder");
  if (!fs::is_directory(path)) return {read_plant(path, o)};
  std::vector<fs::path> files;
  const std::vector<std::string> known = io::mesh_extensions();
  for (const auto& entry : fs::recursive_directory_iterator(path)) {
    if (std::count(known.begin(), known.end(), entry.path().extension().string())) {
      files.push_back(entry.path());
    }
  }
  if (files.empty())
    throw FormatError(path.string(), "", "holds no .obj, .ply, .gltf or .glb file");
  std::sort(files.begin(), files.end());
  std::vector<plant_meshes::PlantSource> plants;
  plants.reserve(files.size());
  for (const fs::path& file : files) plants.push_back(read_plant(file, o));
  return plants;
}

}  // namespace underbrush::pipeline
