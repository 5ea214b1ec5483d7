#include "underbrush/io/log_path.hpp"

#include "underbrush/core/check.hpp"
#include "underbrush/io/table.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {

void refuse_world(const std::filesystem::path& folder) {
  std::error_code error;
  const auto refuse = [&](const char* manifest, const char* reason) {
    if (std::filesystem::exists(folder / manifest, error)) {
      throw FormatError(folder.string(), "", reason);
    }
  };
  refuse("model.json",
         "is a model, expected a log: 'underbrush simulate MODEL --like LOG' makes a log with it");
  refuse("scene.json",
         "is a scene, expected a log: 'underbrush simulate SCENE --like LOG' makes a log with it");
}

const std::filesystem::path& checked_log_path(const std::filesystem::path& path) {
  const auto fail = [&](const std::string& reason) {
    throw FormatError(path.string(), "", reason);
  };
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    refuse_world(path);
    fail("is a folder, expected a log: 'underbrush import FOLDER -o log.ply' makes one of scans");
  }
  const std::string extension = lower(path.extension().string());
  for (const char* mesh : {".obj", ".gltf", ".glb", ".stl"}) {
    if (extension == mesh) fail("is a mesh, expected a log: 'underbrush simulate' takes meshes");
  }
  if (extension == ".txt" && std::filesystem::exists(path, error)) {
    fail(
        "is a text, expected a log (.ply, .ublog): poses are given by --trajectory or --poses, and "
        "'underbrush import' makes a log of points");
  }
  if (is_recording(path)) fail(kRecording);
  for (const char* other : {".pcd", ".bin", ".npy", ".npz", ".csv", ".xyz", ".gz"}) {
    if (extension != other) continue;
    fail("is not a log of Underbrush: 'underbrush import " + path.filename().string() +
         " -o log.ply' makes one of it");
  }
  return path;
}

}  // namespace underbrush::io
