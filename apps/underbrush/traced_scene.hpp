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

namespace underbrush::app {

/// The options of the scene.
struct SceneArguments {
  double tau = 0, grain_m = 0;
  std::vector<std::string> movers;  ///< Each is MODEL:POSES[:MATERIAL].
};

/// Adds the options of the scene to a verb.
void add_scene_options(Verb& verb, SceneArguments& a);

/// Reads the scene in a folder, or a model as a scene without instances. With movers, a model
/// becomes a scene of one instance and the movers. Throws as the readers do, and
/// `std::invalid_argument` for a malformed mover.
elements::Scene scene_of(const std::filesystem::path& folder, const SceneArguments& a,
                         elements::SceneInfo& info);

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
