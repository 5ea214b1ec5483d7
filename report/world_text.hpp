/// \file
/// The reports of `info` and `simulate` on a world in a third-party format.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "underbrush/elements/scene_file.hpp"
#include "underbrush/worlds/read_world.hpp"

namespace underbrush::report {

using Json = nlohmann::ordered_json;

/// The report of the reader, and the classes and materials of the scene.
struct WorldSummary {
  const worlds::WorldReport& read;
  const elements::SceneInfo& info;
};

/// Returns the facts as JSON, and as lines of a report.
Json json_of(const WorldSummary& world);
std::string text_of(const WorldSummary& world);

}  // namespace underbrush::report
