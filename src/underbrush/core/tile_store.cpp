#include "underbrush/core/tile_store.hpp"

#include <cmath>
#include <fstream>
#include <string>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush {
namespace fs = std::filesystem;

namespace {
/// A point and its number within its tile. The number decides whether the point survives thinning.
struct Stored {
  TilePoint p;
  uint32_t number;
};
}  // namespace

struct TileStore::Tile {
  TileKey key;
  std::vector<Stored> memory;
  size_t on_disk = 0;  // records in the file
  size_t kept = 0;     // points whose hash is below the limit
  size_t seen = 0;
  uint64_t limit = ~uint64_t(0);

  uint64_t hash(uint32_t number) const {
    return random_bits(uint64_t(uint32_t(key.i)) << 32 | uint32_t(key.j), number, Purpose::kPlace);
  }
  bool keeps(uint32_t number) const { return limit == ~uint64_t(0) || hash(number) <= limit; }
};

TileStore::TileStore(const TileOptions& options) : options_(options) {
  require(options.tile_m > 0, "tiles must have a positive side");
  require(options.max_points_per_tile >= 1000, "a tile must hold at least 1000 points");
}

TileStore::~TileStore() = default;

TileKey TileStore::key_of(const Vec3f& point) const {
  return {int32_t(std::floor(point.x() / options_.tile_m)),
          int32_t(std::floor(point.y() / options_.tile_m))};
}

void TileStore::add(const TilePoint& p) {
  const TileKey key = key_of(p.point);
  if (!latest_ || latest_->key != key) {
    std::unique_ptr<Tile>& tile = tiles_[key];
    if (!tile) {
      tile = std::make_unique<Tile>();
      tile->key = key;
    }
    latest_ = tile.get();
  }
  Tile* tile = latest_;
  ++size_;
  const uint32_t number = uint32_t(tile->seen++);
  if (!tile->keeps(number)) return;
  tile->memory.push_back({p, number});
  if (++tile->kept > options_.max_points_per_tile) thin(*tile);
  if (++in_memory_ * sizeof(Stored) > options_.memory_bytes) spill();
}

// Halves the share of points that are kept until they fit again. A hash selects them, so that the
// choice is even over time and does not depend on what is in memory.
void TileStore::thin(Tile& tile) {
  tile.limit /= 2;
  const size_t before = tile.memory.size();
  std::erase_if(tile.memory, [&](const Stored& s) { return !tile.keeps(s.number); });
  in_memory_ -= before - tile.memory.size();
  tile.kept = tile.memory.size();
  if (tile.on_disk) {
    const std::vector<Stored> memory = std::move(tile.memory);
    tile.memory.clear();
    for_each_point(tile, [&](const Stored&) { ++tile.kept; });
    tile.memory = memory;
  }
  if (tile.kept > options_.max_points_per_tile) thin(tile);
}

fs::path TileStore::file_of(TileKey key) const {
  return folder_->path() / (std::to_string(key.i) + "_" + std::to_string(key.j) + ".bin");
}

void TileStore::spill() {
  if (!folder_) {
    const fs::path& wanted = options_.spill_folder;
    const fs::path parent = wanted.empty() ? fs::temp_directory_path() : wanted;
    try {
      folder_ = std::make_unique<TemporaryPath>(parent, "tiles");
      make_temporary_folders(folder_->path());
    } catch (const fs::filesystem_error& e) {
      throw IoError(parent.string() + ": cannot write: " + e.code().message());
    }
  }
  for (auto& [key, tile] : tiles_) {
    if (tile->memory.empty()) continue;
    std::ofstream out(file_of(key), std::ios::binary | std::ios::app);
    out.write(reinterpret_cast<const char*>(tile->memory.data()),
              std::streamsize(tile->memory.size() * sizeof(Stored)));
    if (!out.flush()) throw IoError(file_of(key).string() + ": cannot write (disk full?)");
    tile->on_disk += tile->memory.size();
    tile->memory = {};
  }
  in_memory_ = 0;
}

template <class F>
void TileStore::for_each_point(const Tile& tile, F f) const {
  if (tile.on_disk) {
    std::ifstream in(file_of(tile.key), std::ios::binary);
    std::vector<Stored> buffer(1 << 14);
    for (size_t left = tile.on_disk; left > 0;) {
      const size_t n = std::min(left, buffer.size());
      if (!in.read(reinterpret_cast<char*>(buffer.data()), std::streamsize(n * sizeof(Stored)))) {
        throw IoError(file_of(tile.key).string() + ": cannot read back");
      }
      for (size_t k = 0; k < n; ++k) {
        if (tile.keeps(buffer[k].number)) f(buffer[k]);
      }
      left -= n;
    }
  }
  for (const Stored& s : tile.memory) {
    if (tile.keeps(s.number)) f(s);
  }
}

std::vector<TileKey> TileStore::tiles() const {
  std::vector<TileKey> keys;
  for (const auto& [key, tile] : tiles_) keys.push_back(key);
  return keys;
}

Eigen::Vector2d TileStore::corner(TileKey key) const {
  return {key.i * options_.tile_m, key.j * options_.tile_m};
}

TileStore::Loaded TileStore::load(TileKey key, double margin_m) const {
  Loaded out;
  const auto centre = tiles_.find(key);
  require(centre != tiles_.end(), "no such tile");
  const auto add = [&out](const Stored& s) {
    out.point.push_back(s.p.point);
    out.to_sensor.push_back(s.p.to_sensor);
  };
  out.point.reserve(centre->second->kept);
  out.to_sensor.reserve(centre->second->kept);
  for_each_point(*centre->second, add);
  out.core = out.point.size();
  if (!(margin_m > 0)) return out;
  const Eigen::Vector2d lo = corner(key).array() - margin_m;
  const Eigen::Vector2d hi = corner(key).array() + options_.tile_m + margin_m;
  const int reach = int(std::ceil(margin_m / options_.tile_m));
  for (int di = -reach; di <= reach; ++di) {
    for (int dj = -reach; dj <= reach; ++dj) {
      const auto other = tiles_.find({key.i + di, key.j + dj});
      if ((di == 0 && dj == 0) || other == tiles_.end()) continue;
      for_each_point(*other->second, [&](const Stored& s) {
        const double x = s.p.point.x(), y = s.p.point.y();
        if (x >= lo.x() && x < hi.x() && y >= lo.y() && y < hi.y()) add(s);
      });
    }
  }
  return out;
}

size_t TileStore::thinned() const {
  size_t kept = 0;
  for (const auto& [key, tile] : tiles_) kept += tile->kept;
  return size_ - kept;
}

}  // namespace underbrush
