/// \file
/// A scene on disk: a folder with a small JSON manifest, a folder a model, and the table of
/// instances. Layout: docs/reference/formats.md.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "underbrush/elements/classes.hpp"
#include "underbrush/elements/scene.hpp"

namespace underbrush::elements {

/// Version of the layout that is written; newer ones are refused.
inline constexpr int kSceneVersion = 1;

/// What a scene's file holds beside the scene.
struct SceneInfo {
  std::vector<std::string> names;  ///< One a model.
  std::vector<Class> labels;       ///< One an instance; `kGround` for the ground.
  /// One a model: what it is made of (radiometry), "" = as its class says. Empty = all "".
  std::vector<std::string> materials;
  std::vector<Mover> movers;
  std::string provenance;  ///< JSON object.
};

/// Writes the folder `path` (scene.json, models/NNNN/, instances.ply, movers/NNNN.txt), atomically;
/// a scene that stood there is replaced. Throws `IoError`, also if a folder that is no scene stands
/// there.
void write_scene(const std::filesystem::path& path, const Scene& scene, const SceneInfo& info);

/// Throws the `IoError` that `write_scene` would end with now: to be asked before long work.
void check_scene_output(const std::filesystem::path& path);

/// Reads a scene folder. Throws `FormatError` on anything that is not a whole, consistent scene.
Scene read_scene(const std::filesystem::path& path, SceneInfo* info = nullptr);

/// Whether `path` is a scene folder (has a manifest).
bool is_scene(const std::filesystem::path& path);

}  // namespace underbrush::elements
