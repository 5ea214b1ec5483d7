#include "traced_scene.hpp"

#include "stages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/mesh_file.hpp"
#include "underbrush/io/poses.hpp"

namespace underbrush::app {
namespace fs = std::filesystem;
namespace {

struct MoverWords {
  std::string model, poses, material;
};

MoverWords words_of(const std::string& text) {
  const size_t first = text.find(':');
  const size_t second = first == std::string::npos ? first : text.find(':', first + 1);
  require(first != std::string::npos && first > 0 && first + 1 < text.size(),
          "simulate: --mover takes MODEL:POSES.txt or MODEL:POSES.txt:MATERIAL");
  MoverWords w{text.substr(0, first), text.substr(first + 1, second - first - 1), ""};
  if (second != std::string::npos) w.material = text.substr(second + 1);
  return w;
}

}  // namespace

void add_scene_options(Verb& verb, SceneArguments& a) {
  CLI::App& app = verb.app;
  app.add_option("--tau", a.tau,
                 "Mahalanobis distance within which a beam meets an ellipsoid; 0 = the model's")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  verb.begin_rare_group("Meshes and scenes of HELIOS++");
  app.add_option("--up", a.up, "Axis that points up in a mesh; in glTF it always is y")
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str();
  app.add_option("--unit", a.world.mesh.unit_m, "Length of the unit of a mesh, m")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--assets", a.assets,
                 "Folder in which a scene of HELIOS++ has its files, besides its own")
      ->type_name("FOLDER");
  verb.begin_group("Options");
  app.add_option("--mover", a.movers,
                 "Add an object (a model's folder, or an OBJ or PLY mesh) that moves along poses "
                 "(TUM format, world from object); may be repeated")
      ->type_name("MODEL:POSES.txt[:MATERIAL]")
      ->take_all();
}

elements::Model read_mover_model(const fs::path& path) {
  if (fs::is_directory(path)) return elements::read_model(path);
  const io::MeshData mesh = io::read_mesh(path);
  elements::Model model;
  model.fitter = "mesh";
  model.surface.vertices = mesh.vertices;
  model.surface.triangles = mesh.triangles;
  model.surface.hit.resize(mesh.triangles.size());
  return model;
}

void add_mover(elements::Scene& scene, elements::SceneInfo& info, elements::Model model,
               Trajectory world_from_object, const std::string& material) {
  if (scene.instances.empty()) {  // The scene is a model.
    elements::Instance placed;
    placed.world_from_model.translation = scene.models[0].origin;
    scene.instances.push_back(placed);
    info.labels.push_back(elements::Class::kUnknown);
  }
  info.materials.resize(scene.models.size());
  info.movers.push_back({uint32_t(scene.instances.size()), std::move(world_from_object)});
  scene.instances.emplace_back();
  scene.instances.back().model = uint32_t(scene.models.size());
  scene.models.push_back(std::move(model));
  info.labels.push_back(elements::Class::kUnknown);
  info.materials.push_back(material);
}

void set_matter(elements::Scene& scene, double tau, double grain_m) {
  for (elements::Model& model : scene.models) {
    if (tau > 0) model.tau = tau;
    if (grain_m > 0) model.grain = {grain_m, grain_m, {}};
  }
}

elements::Scene scene_of(const fs::path& folder, const SceneArguments& a, elements::SceneInfo& info,
                         worlds::WorldReport* report) {
  worlds::ReadOptions options = a.world;
  options.mesh.y_up = a.up == "y";
  options.assets = a.assets;
  elements::Scene scene = read_world(folder, &info, options, report);
  for (const std::string& text : a.movers) {
    const MoverWords w = words_of(text);
    add_mover(scene, info, read_mover_model(w.model), io::read_trajectory(w.poses), w.material);
  }
  info.materials.resize(scene.models.size());
  set_matter(scene, a.tau, a.grain_m);
  return scene;
}

std::vector<fs::path> mover_files(const SceneArguments& a) {
  std::vector<fs::path> files;
  for (const std::string& text : a.movers) {
    const MoverWords w = words_of(text);
    files.emplace_back(w.model);
    files.emplace_back(w.poses);
  }
  return files;
}

TracedScene traced_scene(const elements::Scene& scene, const elements::SceneInfo& info,
                         trace::Draws draws) {
  TracedScene t;
  if (!info.movers.empty()) {
    t.dynamic_world = std::make_unique<simulate::DynamicWorld>(scene, info.movers, draws);
    return t;
  }
  t.world = std::make_unique<trace::World>(world_of(scene, draws));
  t.dynamic_world = std::make_unique<simulate::DynamicWorld>(*t.world);
  return t;
}

}  // namespace underbrush::app
