/// \file
/// The reader of worlds of regions.
#pragma once
#include <atomic>
#include <filesystem>
#include <memory>
#include <span>

#include "underbrush/elements/scene_file.hpp"
#include "underbrush/regions/index.hpp"

namespace underbrush::regions {

/// A part of a world in memory: a scene, or a model as a scene without instances, with the other
/// contents of a scene's folder. Elements and instances have the numbers that they have in the
/// whole (`elements::PartOf`, `elements::Scene::numbers`), so that beams that meet nothing else
/// have the answers of the whole, to the bit.
struct WorldPart {
  elements::Scene scene;
  elements::SceneInfo info;
};

/// Returns the files whose hashes identify a world: its index, which has the hashes of all regions,
/// and the folder of its common part; for any other path, the path itself.
std::vector<std::filesystem::path> hashed_parts(const std::filesystem::path& path);

/// A world on disk.
class WorldFolder {
 public:
  /// Reads the index and the common part of all regions. Throws `FormatError`.
  explicit WorldFolder(std::filesystem::path path);

  const Index& index() const { return index_; }
  /// Bytes of memory that the common part of all regions takes, as an estimate.
  uint64_t common_bytes() const;
  /// Reads regions, which are named by their places in the index and each once. Without regions,
  /// the part is the common one. Throws `FormatError` for a region that is damaged, or whose hash
  /// is not that of the index, which is checked when it is read first.
  WorldPart part(std::span<const uint32_t> regions) const;
  /// Reads all regions: the world as one that was never cut.
  WorldPart whole() const;

 private:
  std::filesystem::path path_;
  Index index_;
  WorldPart common_;
  std::shared_ptr<std::atomic<bool>[]> checked_;  ///< Whether a region's hash is that of the index.
  /// The vertices of the whole's ground; null where no space is unknown.
  std::shared_ptr<const elements::TriangleMesh> ground_;
};

}  // namespace underbrush::regions
