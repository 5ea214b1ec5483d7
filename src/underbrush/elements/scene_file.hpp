/// \file
/// Scenes on disk: a folder with a small JSON manifest, a folder for each model, and the table of
/// instances. Layout: docs/reference/formats.md.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "underbrush/elements/classes.hpp"
#include "underbrush/elements/scene.hpp"

namespace underbrush::elements {

/// Version of the layout that is written; newer versions are refused.
inline constexpr int kSceneVersion = 1;

/// A material that a scene brings along: pairs of wavelength (m) and reflectance, in rising order
/// of wavelength. A single pair holds at every wavelength.
struct SceneMaterial {
  std::string name;
  std::vector<std::pair<double, double>> reflectance;
};

/// The contents of a scene's folder besides the scene: names, classes, materials and movers.
struct SceneInfo {
  std::vector<std::string> names;  ///< The name of each model.
  std::vector<Class> labels;       ///< The class of each instance; `kGround` for the ground.
  /// Names of the classes that this scene has besides `kClassNames`, whose numbers follow those.
  std::vector<std::string> class_names;
  std::vector<SceneMaterial> own_materials;  ///< Materials besides those of the table.
  /// The material (radiometry) of each model, where "" means that its class decides. Empty = all
  /// "".
  std::vector<std::string> materials;
  /// Instances that move.
  std::vector<Mover> movers;
  std::string provenance;  ///< JSON object.
};

/// Returns the name of a class of the scene.
std::string class_name(const SceneInfo& info, Class c);
/// Returns the class of that name, which is added to the scene's if it is a new one; `kUnknown` for
/// an empty name, and where the scene has 256 classes already.
Class class_named(SceneInfo& info, std::string_view name);
/// Returns the names of all classes of a scene with classes of its own, by number; otherwise none.
std::vector<std::string> element_classes(const SceneInfo& info);

/// Writes the folder `path` (scene.json, models/NNNN/, instances.ply, movers/NNNN.txt), atomically,
/// replacing a scene that stood there. Throws `IoError`, also if a folder that is not a scene
/// stands there.
void write_scene(const std::filesystem::path& path, const Scene& scene, const SceneInfo& info);

/// Throws the `IoError` that `write_scene` would end with. Callers use it before a long
/// computation.
void check_scene_output(const std::filesystem::path& path);

/// Reads a scene folder, and the rest of its contents into `info` (unless null). Throws
/// `FormatError` for anything that is not a whole, consistent scene.
Scene read_scene(const std::filesystem::path& path, SceneInfo* info = nullptr);

/// Writes instances and their classes as a table. Throws `IoError`.
void write_instances(const std::filesystem::path& path, std::span<const Instance> instances,
                     std::span<const Class> labels);
/// Reads a table of instances and adds these to those of the scene, and their classes to `info`,
/// which has the names of the scene's classes. Throws `FormatError`.
void read_instances(const std::filesystem::path& file, Scene& scene, SceneInfo& info);

/// Whether `path` is a scene folder, which has a manifest.
bool is_scene(const std::filesystem::path& path);

}  // namespace underbrush::elements
