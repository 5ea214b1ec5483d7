#include "underbrush/io/mesh_file.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/within.hpp"
#include "underbrush/io/gltf_mesh.hpp"
#include "underbrush/io/mesh_readers.hpp"
#include "underbrush/io/ply.hpp"
#include "underbrush/io/ply_header.hpp"
#include "underbrush/io/polygon.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

std::string extension_of(const fs::path& path) {
  std::string e = path.extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return std::tolower(c); });
  return e;
}

/// Adds the faces of a PLY file; those of more than three corners are cut as polygons.
void add_polygons(const PlyElement& face, MeshScene& mesh) {
  const auto* triangle = face.triangles.data();
  for (const uint32_t n : face.fans) {
    std::vector<uint32_t> index;
    std::vector<Vec3> corners;
    corners.reserve(n + 2);
    for (uint32_t k = 0; k < n; ++k) {
      if (k == 0) index = {triangle[0][0], triangle[0][1]};
      index.push_back(triangle[k][2]);
    }
    for (const uint32_t v : index) corners.push_back(mesh.vertices[v]);
    for (const auto& t : triangles_of_polygon(corners)) {
      mesh.add({index[t[0]], index[t[1]], index[t[2]]}, {});
    }
    triangle += n;
  }
}

MeshScene read_ply_scene(const fs::path& path) {
  for (const PlyHeader::Element& element : read_ply_header(InputFile(path)).elements) {
    if (element.name != "tristrips") continue;
    throw FormatError(path.string(), "",
                      "its triangles are in strips (tristrips), which are not read: save it with "
                      "faces, as MeshLab does");
  }
  const PlyData data = read_ply(path);
  const PlyElement* vertex = data.find("vertex");
  const PlyElement* face = data.find("face");
  if (!vertex || !face) throw FormatError(path.string(), "", "no elements vertex and face");
  MeshScene mesh;
  mesh.vertices.resize(vertex->count);
  const char* names[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    const ExtraColumn* column = vertex->find(names[axis]);
    if (!column) throw FormatError(path.string(), "", std::string("no column ") + names[axis]);
    std::visit(
        [&](const auto& values) {
          for (size_t i = 0; i < vertex->count; ++i) mesh.vertices[i][axis] = double(values[i]);
        },
        *column);
  }
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (!is_within(mesh.vertices[i], 1e9)) {
      throw FormatError(path.string(), "vertex " + std::to_string(i), "not finite");
    }
  }
  for (size_t i = 0; i < face->triangles.size(); ++i) {
    for (const uint32_t v : face->triangles[i]) {
      if (v >= mesh.vertices.size()) {
        throw FormatError(path.string(), "triangle " + std::to_string(i), "names no vertex");
      }
    }
  }
  add_polygons(*face, mesh);
  return mesh;
}

}  // namespace

void MeshScene::add(const std::array<uint32_t, 3>& triangle, const MeshPart& of) {
  if (parts.empty() || parts[last_].object != of.object || parts[last_].material != of.material) {
    const auto [at, added] = part_of_.try_emplace({of.object, of.material}, uint32_t(parts.size()));
    if (added) parts.push_back(of);
    last_ = at->second;
  }
  triangles.push_back(triangle);
  part.push_back(last_);
}

double mesh_coordinate(const fs::path& path, const std::string& place, std::string_view word) {
  const auto value = number_of(word);
  if (!value || !(std::abs(*value) <= 1e9)) {
    throw FormatError(path.string(), place, in_quotes(word) + " is not a finite number");
  }
  return *value;
}

std::vector<std::string> mesh_extensions() { return {".obj", ".ply", ".gltf", ".glb"}; }

std::vector<std::string> mesh_scene_extensions() {
  return {".obj", ".ply", ".gltf", ".glb", ".stl"};
}

bool is_gltf(const fs::path& path) {
  const std::string extension = extension_of(path);
  return extension == ".gltf" || extension == ".glb";
}

MeshScene read_mesh_scene(const fs::path& path, bool with_materials) {
  const std::string extension = extension_of(path);
  MeshScene mesh;
  if (extension == ".obj") {
    mesh = read_obj(path, with_materials);
  } else if (extension == ".ply") {
    mesh = read_ply_scene(path);
  } else if (extension == ".stl") {
    mesh = read_stl(path);
  } else if (is_gltf(path)) {
    mesh = read_gltf(path);
  } else {
    throw FormatError(path.string(), "",
                      "no mesh format that is known; .obj, .ply, .gltf, .glb and .stl are");
  }
  if (mesh.triangles.empty()) throw FormatError(path.string(), "", "it has no triangles");
  return mesh;
}

MeshData read_mesh(const fs::path& path) {
  MeshScene scene = read_mesh_scene(path, false);
  MeshData mesh;
  mesh.vertices.reserve(scene.vertices.size());
  for (const Vec3& v : scene.vertices) mesh.vertices.push_back(v.cast<float>());
  mesh.triangles = std::move(scene.triangles);
  return mesh;
}

}  // namespace underbrush::io
