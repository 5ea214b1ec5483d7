#include <bit>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/within.hpp"
#include "underbrush/io/mesh_readers.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

constexpr size_t kHeader = 84, kRow = 50;  // bytes

/// Gives equal corners one vertex.
class Vertices {
 public:
  explicit Vertices(MeshScene& mesh) : mesh_(mesh) {}
  uint32_t number_of(const Vec3& v) {
    const auto [at, added] = number_.try_emplace({v.x(), v.y(), v.z()}, mesh_.vertices.size());
    if (added) mesh_.vertices.push_back(v);
    return at->second;
  }

 private:
  struct Hash {
    size_t operator()(const std::array<double, 3>& v) const {
      size_t h = 0;
      for (const double x : v) h = (h ^ std::bit_cast<uint64_t>(x + 0.0)) * 0x9e3779b97f4a7c15ull;
      return h ^ (h >> 31);
    }
  };
  MeshScene& mesh_;
  std::unordered_map<std::array<double, 3>, uint32_t, Hash> number_;
};

MeshScene read_binary(const fs::path& path, const std::string& bytes) {
  if (bytes.size() < kHeader)
    throw FormatError(path.string(), "", "truncated: the header has 84 bytes");
  uint32_t n = 0;
  std::memcpy(&n, bytes.data() + 80, 4);
  const uint64_t there = (bytes.size() - kHeader) / kRow;
  if (there < n) {
    throw FormatError(path.string(), "",
                      "truncated, or no STL file: by its header it has " + std::to_string(n) +
                          " triangles, and bytes for " + std::to_string(there));
  }
  MeshScene mesh;
  const uint64_t behind = bytes.size() - kHeader - kRow * uint64_t(n);
  if (behind > 0 && behind % kRow == 0) {
    throw FormatError(path.string(), "",
                      "its header counts " + std::to_string(n) +
                          " triangles, and it has bytes for " + std::to_string(there));
  }
  if (behind > 0) mesh.left_out["bytes behind the last triangle"] = behind;
  Vertices vertices(mesh);
  for (size_t k = 0; k < n; ++k) {
    float v[9];
    std::memcpy(v, bytes.data() + kHeader + k * kRow + 12, sizeof v);
    std::array<uint32_t, 3> corner{};
    for (size_t c = 0; c < 3; ++c) {
      const Vec3 x(v[3 * c], v[3 * c + 1], v[3 * c + 2]);
      if (!is_within(x, 1e9)) {
        throw FormatError(path.string(), "triangle " + std::to_string(k), "not finite");
      }
      corner[c] = vertices.number_of(x);
    }
    mesh.add(corner, {});
  }
  return mesh;
}

MeshScene read_ascii(const fs::path& path, const std::string& text) {
  MeshScene mesh;
  Vertices vertices(mesh);
  MeshPart part;
  std::vector<uint32_t> corner;
  for_each_line(text, [&](size_t line, std::string_view content) {
    const auto words = words_of(content);
    if (words.empty()) return;
    const std::string kind = lower(std::string(words[0]));
    const std::string place = "line " + std::to_string(line);
    if (kind == "solid") {
      part.object = words.size() > 1 ? std::string(words[1]) : "";
    } else if (kind == "vertex") {
      if (words.size() < 4) throw FormatError(path.string(), place, "fewer than three values");
      const double x = mesh_coordinate(path, place, words[1]);
      const double y = mesh_coordinate(path, place, words[2]);
      corner.push_back(vertices.number_of({x, y, mesh_coordinate(path, place, words[3])}));
    } else if (kind == "endfacet") {
      if (corner.size() != 3) throw FormatError(path.string(), place, "a facet of not 3 vertices");
      mesh.add({corner[0], corner[1], corner[2]}, part);
      corner.clear();
    }
  });
  if (!corner.empty()) throw FormatError(path.string(), "", "the last facet does not end");
  return mesh;
}

}  // namespace

MeshScene read_stl(const fs::path& path) {
  constexpr size_t kBeginning = 1024;
  const std::string bytes = read_file(path, kMostMeshBytes);
  uint32_t count = 0;
  if (bytes.size() >= kHeader) std::memcpy(&count, bytes.data() + 80, 4);
  const bool exact = bytes.size() >= kHeader && bytes.size() == kHeader + kRow * uint64_t(count);
  // Headers of binary files may begin with "solid" too.
  const std::string beginning = lower(bytes.substr(0, kBeginning));
  const size_t first = beginning.find_first_not_of(" \t\r\n");
  const bool text = first != std::string::npos && beginning.compare(first, 5, "solid") == 0 &&
                    (beginning.find("facet") != std::string::npos ||
                     beginning.find("endsolid") != std::string::npos);
  return text && !exact ? read_ascii(path, bytes) : read_binary(path, bytes);
}

}  // namespace underbrush::io
