/// \file
/// Storage of a log's points by tile, so that a log larger than memory can be processed.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/core/temporary.hpp"

namespace underbrush {

/// A point and the direction from which it was seen.
struct TilePoint {
  Vec3f point;      ///< m, relative to the store's origin.
  Vec3f to_sensor;  ///< m, from the point to the sensor.
};

/// Width (m) of the margin around a tile. Points in it help to segment the tile's ground.
inline constexpr double kTileMarginM = 10;

/// Options of `TileStore`.
struct TileOptions {
  double tile_m = 32;  ///< m; side of a square tile in x and y.
  /// A fuller tile is thinned out evenly; the points that it loses are counted.
  size_t max_points_per_tile = 4'000'000;
  size_t memory_bytes = size_t(1) << 30;  ///< Points held in memory, in bytes; further points go to
                                          ///< disk.
  std::filesystem::path spill_folder;     ///< Empty means the system's folder for temporary files.
};

/// Index of a tile, which covers [i, i+1) × [j, j+1) in units of the tile's side.
struct TileKey {
  int32_t i = 0, j = 0;
  auto operator<=>(const TileKey&) const = default;
};

/// Collects points by tile, moves them to disk where memory runs short, and gives them back tile by
/// tile. The result depends only on the points and their order, not on the memory allowed.
class TileStore {
 public:
  explicit TileStore(const TileOptions& options = {});
  ~TileStore();
  TileStore(const TileStore&) = delete;
  TileStore& operator=(const TileStore&) = delete;

  void add(const TilePoint& p);

  /// Returns the tile in which a point lies.
  TileKey key_of(const Vec3f& point) const;
  /// Returns all tiles that hold points, in ascending order.
  std::vector<TileKey> tiles() const;
  /// Returns the corner of a tile with the least x and y (m).
  Eigen::Vector2d corner(TileKey key) const;
  /// The points of one tile and of its margin: first the `core` points of the tile in order of
  /// arrival, then points of other tiles.
  struct Loaded {
    std::vector<Vec3f> point, to_sensor;
    size_t core = 0;
  };
  /// Loads a tile and the points of other tiles within `margin_m` of it. Several threads may call
  /// it at once. Throws `std::invalid_argument` for a tile without points.
  Loaded load(TileKey key, double margin_m) const;

  size_t size() const { return size_; }
  /// Returns how many points were left out so far because their tile was full.
  size_t thinned() const;

 private:
  struct Tile;
  void spill();
  void thin(Tile& tile);
  template <class F>
  void for_each_point(const Tile& tile, F f) const;
  std::filesystem::path file_of(TileKey key) const;

  TileOptions options_;
  std::map<TileKey, std::unique_ptr<Tile>> tiles_;
  Tile* latest_ = nullptr;  ///< The tile of the last point added.
  size_t size_ = 0, in_memory_ = 0;
  /// Folder of the spilled points; created with the first spill.
  std::unique_ptr<TemporaryPath> folder_;
};

}  // namespace underbrush
