/// What a world in a third-party format became, for people to read.
#pragma once
#include "cli/verb.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/worlds/read_world.hpp"

namespace underbrush::app {

/// What was read, and the classes and materials of the scene.
struct WorldSummary {
  const worlds::WorldReport& read;
  const elements::SceneInfo& info;
};

/// Returns the facts as JSON, and as lines of a report.
Json json_of(const WorldSummary& world);
std::string text_of(const WorldSummary& world);

}  // namespace underbrush::app
