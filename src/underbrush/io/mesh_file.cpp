#include "underbrush/io/mesh_file.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/gltf_mesh.hpp"
#include "underbrush/io/ply.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

constexpr uint64_t kMostBytes = uint64_t(1) << 31;

std::string extension_of(const fs::path& path) {
  std::string e = path.extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return std::tolower(c); });
  return e;
}

float coordinate(const fs::path& path, const std::string& place, std::string_view word) {
  const auto value = number_of(word);
  if (!value || !std::isfinite(float(*value))) {
    throw FormatError(path.string(), place, in_quotes(word) + " is not a finite number");
  }
  return float(*value);
}

/// Returns the vertex that a corner "v", "v/t" or "v/t/n" of a face names. Numbers count from 1;
/// negative ones count back from the last vertex.
uint32_t corner(const fs::path& path, const std::string& place, std::string_view word, size_t n) {
  const auto value = number_of(word.substr(0, word.find('/')));
  const double index = !value ? 0 : *value < 0 ? double(n) + *value + 1 : *value;
  if (!(index >= 1 && index <= double(n)) || index != std::floor(index)) {
    throw FormatError(path.string(), place, in_quotes(word) + " names no vertex");
  }
  return uint32_t(index) - 1;
}

MeshData read_obj(const fs::path& path) {
  const std::string text = read_file(path, kMostBytes);
  MeshData mesh;
  for_each_line(text, [&](size_t line, std::string_view content) {
    const auto words = words_of(content);
    if (words.empty() || (words[0] != "v" && words[0] != "f")) return;
    const std::string place = "line " + std::to_string(line);
    if (words.size() < 4) {
      throw FormatError(path.string(), place,
                        "fewer than three values after " + std::string(words[0]));
    }
    if (words[0] == "v") {
      const float x = coordinate(path, place, words[1]), y = coordinate(path, place, words[2]);
      mesh.vertices.emplace_back(x, y, coordinate(path, place, words[3]));
      return;
    }
    const size_t n = mesh.vertices.size();
    const uint32_t first = corner(path, place, words[1], n);
    uint32_t last = corner(path, place, words[2], n);
    for (size_t k = 3; k < words.size(); ++k) {
      const uint32_t next = corner(path, place, words[k], n);
      mesh.triangles.push_back({first, last, next});
      last = next;
    }
  });
  return mesh;
}

MeshData read_ply_mesh(const fs::path& path) {
  const PlyData data = read_ply(path);
  const PlyElement* vertex = data.find("vertex");
  const PlyElement* face = data.find("face");
  if (!vertex || !face) throw FormatError(path.string(), "", "no elements vertex and face");
  MeshData mesh;
  mesh.triangles = face->triangles;
  mesh.vertices.resize(vertex->count);
  const char* names[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    const ExtraColumn* column = vertex->find(names[axis]);
    if (!column) throw FormatError(path.string(), "", std::string("no column ") + names[axis]);
    std::visit(
        [&](const auto& values) {
          for (size_t i = 0; i < vertex->count; ++i) mesh.vertices[i][axis] = float(values[i]);
        },
        *column);
  }
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (!mesh.vertices[i].allFinite()) {
      throw FormatError(path.string(), "vertex " + std::to_string(i), "not finite");
    }
  }
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const uint32_t v : mesh.triangles[i]) {
      if (v >= mesh.vertices.size()) {
        throw FormatError(path.string(), "triangle " + std::to_string(i), "names no vertex");
      }
    }
  }
  return mesh;
}

}  // namespace

std::vector<std::string> mesh_extensions() { return {".obj", ".ply", ".gltf", ".glb"}; }

bool is_gltf(const fs::path& path) {
  const std::string extension = extension_of(path);
  return extension == ".gltf" || extension == ".glb";
}

MeshData read_mesh(const fs::path& path) {
  const std::string extension = extension_of(path);
  MeshData mesh;
  if (extension == ".obj") {
    mesh = read_obj(path);
  } else if (extension == ".ply") {
    mesh = read_ply_mesh(path);
  } else if (is_gltf(path)) {
    mesh = read_gltf(path);
  } else {
    throw FormatError(path.string(), "",
                      "no mesh format that is known; .obj, .ply, .gltf and .glb are");
  }
  if (mesh.triangles.empty()) throw FormatError(path.string(), "", "it has no triangles");
  return mesh;
}

}  // namespace underbrush::io
