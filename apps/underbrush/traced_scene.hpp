/// \file
/// What `simulate` fires into: a model or a scene, and movers.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/verb.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/simulate/dynamic_world.hpp"

namespace underbrush::app {

/// What the user says of it.
struct SceneArguments {
  double tau = 0;
  std::vector<std::string> movers;  ///< MODEL:POSES[:MATERIAL].
};

void add_scene_options(Verb& verb, SceneArguments& a);

/// The scene in a folder, or a model as a scene of no instances; with movers, one of one instance
/// and the movers. Throws as the readers do, `std::invalid_argument` for a mover that is misspelt.
elements::Scene scene_of(const std::filesystem::path& folder, const SceneArguments& a,
                         elements::SceneInfo& info);

/// The files that movers come from.
std::vector<std::filesystem::path> mover_files(const SceneArguments& a);

/// A scene to be fired into, which must outlive it.
struct TracedScene {
  std::unique_ptr<trace::World> world;
  std::unique_ptr<simulate::DynamicWorld> dynamic_world;
};
TracedScene traced_scene(const elements::Scene& scene, const elements::SceneInfo& info);

}  // namespace underbrush::app
