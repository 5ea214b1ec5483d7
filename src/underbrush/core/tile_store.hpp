/// \file
/// The points of a log by tile, so that a log larger than memory can be fitted.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/core/temporary.hpp"

namespace underbrush {

/// A point and from where it was seen.
struct TilePoint {
  Vec3f point;      ///< m, relative to the store's origin.
  Vec3f to_sensor;  ///< m, from the point to the sensor.
};

/// Margin around a tile in which points help to tell its ground, m.
inline constexpr double kTileMarginM = 10;

/// Options of `TileStore`.
struct TileOptions {
  double tile_m = 32;                      ///< Side of a square tile in x and y.
  size_t max_points_per_tile = 4'000'000;  ///< More are thinned out evenly (and counted).
  size_t memory_bytes = size_t(1) << 30;   ///< Held in memory; what exceeds it goes to disk.
  std::filesystem::path spill_folder;      ///< Default: the system's folder for temporary files.
};

/// A tile's place: it covers [i, i+1) × [j, j+1) tile sides.
struct TileKey {
  int32_t i = 0, j = 0;
  auto operator<=>(const TileKey&) const = default;
};

/// Collects points by tile, spilling to disk as needed; then gives them back tile by tile. What it
/// gives depends only on the points and their order, not on the memory allowed.
class TileStore {
 public:
  explicit TileStore(const TileOptions& options = {});
  ~TileStore();
  TileStore(const TileStore&) = delete;
  TileStore& operator=(const TileStore&) = delete;

  void add(const TilePoint& p);

  /// The tile in which a point lies.
  TileKey key_of(const Vec3f& point) const;
  /// All tiles with points, in order.
  std::vector<TileKey> tiles() const;
  /// Lower corner of a tile (m).
  Eigen::Vector2d corner(TileKey key) const;
  /// The points of a tile in order of arrival, `core` in number, then those of other tiles within
  /// `margin_m` of it. May be called from several threads.
  struct Loaded {
    std::vector<Vec3f> point, to_sensor;
    size_t core = 0;
  };
  Loaded load(TileKey key, double margin_m) const;

  size_t size() const { return size_; }
  /// Points left out so far because their tile was full.
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
  Tile* latest_ = nullptr;  ///< That of the last point added.
  size_t size_ = 0, in_memory_ = 0;
  std::unique_ptr<TemporaryPath> folder_;  ///< Once something was spilled.
};

}  // namespace underbrush
