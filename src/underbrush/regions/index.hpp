/// \file
/// The index of a world of regions: a folder of squares, of which a reader opens those that beams
/// can reach. Layout: docs/reference/formats.md.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/core/cells.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush {
/// Worlds that are larger than memory: models and scenes cut into square regions.
namespace regions {

/// Version of the layout that is written; newer versions are refused.
inline constexpr int kWorldVersion = 1;
/// The content of a square: the elements and instances whose middles lie in it.
struct Region {
  Cell2 square;                ///< In sides.
  Eigen::AlignedBox3d bounds;  ///< m, world; the box of all that a ray can meet.
  /// Elements of the model that is cut, by `elements::Kind`.
  std::array<uint32_t, 3> elements{};
  uint32_t instances = 0;
  std::string hash;  ///< The hash of the region's folder (`io::hash_of`).

  /// Bytes of memory that the region takes when rays are traced in it, as an estimate.
  uint64_t bytes() const;
};

/// The index of a world.
struct Index {
  double side_m = 0;      ///< m
  bool is_scene = false;  ///< Whether the world is a scene, else one model.
  /// The whole's `elements::mean_reflectance`, by `elements::Kind`.
  std::array<elements::MeanReflectance, 3> reflectance;
  /// The numbers of the instances of the common part, ascending.
  std::vector<uint32_t> common_instances;
  std::vector<Region> regions;  ///< In rows from south to north, in a row from west to east.
  std::string provenance;       ///< JSON object.

  /// Elements of the model that is cut, by `elements::Kind`.
  std::array<uint32_t, 3> elements() const;
  /// Instances, those of the common part included.
  uint32_t instances() const;
};

/// The folder of a region in the world's folder.
std::filesystem::path folder_of(const Cell2& square);

/// Whether `path` is a world of regions, which has an index.
bool is_world(const std::filesystem::path& path);

/// Writes the file `index.json` (share/schemas/world.json) into the folder `path`. Throws
/// `IoError`.
void write_index(const std::filesystem::path& path, const Index& index);
/// Reads the index of the world in the folder `path`. Throws `FormatError`.
Index read_index(const std::filesystem::path& path);

}  // namespace regions
}  // namespace underbrush
