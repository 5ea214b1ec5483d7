// What the library's readers of files can do elsewhere and the FMU cannot: it would need further
// shared libraries.
#include "underbrush/core/check.hpp"
#include "underbrush/io/gltf_mesh.hpp"
#include "underbrush/io/gzip.hpp"
#include "underbrush/io/log_rows.hpp"
#include "underbrush/io/table.hpp"

namespace underbrush::io {

MeshScene read_gltf(const std::filesystem::path& path) {
  throw FormatError(path.string(), "", "the FMU reads no glTF: convert it to OBJ or PLY");
}

Table read_pcd(const std::filesystem::path& path) {
  throw FormatError(path.string(), "", "the FMU reads no PCD");
}

bool is_compact(const std::filesystem::path&) { return false; }

std::unique_ptr<LogRows> open_compact_rows(const std::filesystem::path& path) {
  throw FormatError(path.string(), "", "the FMU reads no compact logs");
}

std::unique_ptr<LogSink> begin_compact(OutputFile&, const LogComments&) {
  throw std::invalid_argument("the FMU writes no compact logs");
}

bool is_gzip(const std::filesystem::path&) { return false; }

Unpacked::Unpacked(const std::filesystem::path& packed) : temporary_("", "") {
  throw FormatError(packed.string(), "", "the FMU reads no files of gzip");
}

}  // namespace underbrush::io
