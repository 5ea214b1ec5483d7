/// \file
/// The readers behind `read_mesh_scene`, one for each format.
#pragma once
#include <string_view>

#include "underbrush/io/mesh_scene.hpp"

namespace underbrush::io {

/// The largest size of a mesh file, bytes.
inline constexpr uint64_t kMostMeshBytes = uint64_t(1) << 31;

/// Reads v, f, o, g, usemtl and, if `with_materials`, mtllib lines. Polygons become triangles
/// (`triangles_of_polygon`). Throws `FormatError`.
MeshScene read_obj(const std::filesystem::path& path, bool with_materials);
/// Reads an MTL file: newmtl, helios_reflectance, helios_classification, helios_isGround and
/// helios_spectra, whose table NAME.txt is looked for beside the MTL file and in the folder spectra
/// there. Counts the lines that it does not use in `left_out`. Throws `FormatError`.
std::vector<MeshMaterial> read_mtl(const std::filesystem::path& path,
                                   std::map<std::string, size_t>& left_out);
/// Reads a spectrum as the ASTER and ECOSTRESS libraries and HELIOS++ have it: 26 lines of header,
/// then wavelength (µm) and reflectance (%). Returns pairs of wavelength (m) and share. Throws
/// `FormatError`.
std::vector<std::pair<double, double>> read_spectrum(const std::filesystem::path& path);
/// Reads binary or ASCII STL, in which every `solid` is an object. Throws `FormatError`.
MeshScene read_stl(const std::filesystem::path& path);

/// Parses a coordinate. Throws `FormatError` where it is not a finite number within ±1e9.
double mesh_coordinate(const std::filesystem::path& path, const std::string& place,
                       std::string_view word);

}  // namespace underbrush::io
