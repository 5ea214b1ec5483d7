/// \file
/// Meshes as their files describe them: objects, materials, and coordinates in double precision.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::io {

/// A material that a mesh file brings along.
struct MeshMaterial {
  std::string name;
  /// Pairs of wavelength (m) and reflectance, in rising order of wavelength. A single pair holds at
  /// every wavelength. Empty if the file has no reflectance.
  std::vector<std::pair<double, double>> reflectance;
  std::optional<int> classification;  ///< `helios_classification`: a class as in LAS, 0 to 255.
};

/// Triangles of one object and one material.
struct MeshPart {
  std::string object, material;  ///< Names; empty where the file has none.
};

/// A mesh file with all of its data that affect the beams.
struct MeshScene {
  std::vector<Vec3> vertices;  ///< In the unit and axes of the file, as precise as there.
  std::vector<std::array<uint32_t, 3>> triangles;  ///< In the order of the file.
  std::vector<uint32_t> part;                      ///< Index into `parts`, one for each triangle.
  std::vector<MeshPart> parts;                     ///< In the order of their first triangles.
  std::vector<MeshMaterial> materials;
  /// Number of things in the file that this reader does not use, by kind.
  std::map<std::string, size_t> left_out;

  /// Appends a triangle of the part that `of` describes.
  void add(const std::array<uint32_t, 3>& triangle, const MeshPart& of);

 private:
  std::map<std::pair<std::string, std::string>, uint32_t> part_of_;
  uint32_t last_ = 0;
};

/// Returns the extensions that `read_mesh_scene` takes, in lower case: .obj, .ply, .gltf, .glb,
/// .stl.
std::vector<std::string> mesh_scene_extensions();

/// Reads a mesh in the format that its extension names: OBJ with its MTL files, PLY, glTF or STL
/// (docs/reference/formats.md). Throws `FormatError` for another extension, a mesh without
/// triangles, a coordinate that is not a finite number within ±1e9, or a face that names no vertex.
/// The files of materials that an OBJ file names are read if `with_materials`.
MeshScene read_mesh_scene(const std::filesystem::path& path, bool with_materials = true);

}  // namespace underbrush::io
