/// \file
/// The world that `simulate` traces: a model or a scene, with movers.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/verb.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/simulate/dynamic_world.hpp"
#include "underbrush/worlds/read_world.hpp"

namespace underbrush::app {

/// The options of the scene.
struct SceneArguments {
  double tau = 0, grain_m = 0;
  std::string up = "z";             ///< Axis that points up in a mesh.
  std::string assets;               ///< Folder in which a scene of HELIOS++ has its files, too.
  worlds::ReadOptions world;        ///< How a world in a third-party format is read.
  std::vector<std::string> movers;  ///< Each is MODEL:POSES[:MATERIAL].
};

/// Adds the options of the scene to a verb.
void add_scene_options(Verb& verb, SceneArguments& a);

/// Reads the scene in a folder, a model as a scene without instances, or a world in a third-party
/// format, into `report`. With movers, a model
/// becomes a scene of one instance and the movers. Throws as the readers do, and
/// `std::invalid_argument` for a malformed mover.
elements::Scene scene_of(const std::filesystem::path& folder, const SceneArguments& a,
                         elements::SceneInfo& info, worlds::WorldReport* report = nullptr);

/// Reads a model's folder, or a mesh from an OBJ or PLY file.
elements::Model read_mover_model(const std::filesystem::path& path);
/// Adds an object that moves. A scene that is a model becomes a scene of one instance before.
void add_mover(elements::Scene& scene, elements::SceneInfo& info, elements::Model model,
               Trajectory world_from_object, const std::string& material);
/// Replaces τ and the grain of all models, each unless it is 0.
void set_matter(elements::Scene& scene, double tau, double grain_m);

/// Returns the files that the movers come from.
std::vector<std::filesystem::path> mover_files(const SceneArguments& a);

/// A scene prepared for tracing. The scene must outlive it.
struct TracedScene {
  std::unique_ptr<trace::World> world;
  std::unique_ptr<simulate::DynamicWorld> dynamic_world;
};
/// Prepares a scene for tracing.
TracedScene traced_scene(const elements::Scene& scene, const elements::SceneInfo& info,
                         trace::Draws draws);

}  // namespace underbrush::app
