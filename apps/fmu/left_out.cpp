// What the library's readers of files do elsewhere, for which the FMU would need shared libraries.
#include "underbrush/core/check.hpp"
#include "underbrush/io/gltf_mesh.hpp"
#include "underbrush/io/gzip.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/io/table.hpp"

namespace underbrush::io {

MeshScene read_gltf(const std::filesystem::path& path) {
  throw FormatError(path.string(), "", "the FMU reads no glTF: convert it to OBJ or PLY");
}

Table read_pcd(const std::filesystem::path& path) {
  throw FormatError(path.string(), "", "the FMU reads no PCD");
}

bool is_gzip(const std::filesystem::path&) { return false; }
const CompactFormat* compact_format() { return nullptr; }

Unpacked::Unpacked(const std::filesystem::path& packed) : temporary_("", "") {
  throw FormatError(packed.string(), "", "the FMU reads no files of gzip");
}

}  // namespace underbrush::io
