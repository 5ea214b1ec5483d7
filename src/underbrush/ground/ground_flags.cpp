#include "underbrush/ground/ground_flags.hpp"

#include <map>

#include "underbrush/core/parallel.hpp"
#include "underbrush/core/tile_store.hpp"

namespace underbrush::ground {
namespace {

/// Calls `f(point)` for each hit (m, relative to `origin`).
template <class F>
void for_each_hit(BeamSource& source, const Vec3& origin, F f) {
  source.rewind();
  for (BeamLog chunk; source.next(chunk);) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (chunk.is_hit(i)) f(Vec3f((chunk.end_point(i) - origin).cast<float>()));
    }
  }
}

}  // namespace

std::vector<uint8_t> ground_flags(BeamSource& source, const ground::SegmentOptions& options,
                                  double tile_m,
                                  const std::function<void(size_t, size_t)>& progress) {
  TileOptions tiles;
  tiles.tile_m = tile_m;
  tiles.max_points_per_tile = SIZE_MAX;  // No tile is thinned, because every hit needs a flag.
  TileStore store(tiles);
  const Vec3 origin = log_origin(source).value_or(Vec3::Zero());
  for_each_hit(source, origin, [&](const Vec3f& point) { store.add({point, Vec3f::UnitZ()}); });

  const std::vector<TileKey> keys = store.tiles();
  std::vector<std::vector<uint8_t>> found(keys.size());
  const size_t batch = 4 * size_t(threads());
  for (size_t at = 0; at < keys.size(); at += batch) {
    const size_t n = std::min(batch, keys.size() - at);
    parallel_for(n, 1, [&](size_t k, size_t) {
      const TileStore::Loaded loaded = store.load(keys[at + k], kTileMarginM);
      found[at + k] = ground::segment(loaded.point, options);
      found[at + k].resize(loaded.core);
      found[at + k].shrink_to_fit();
    });
    if (progress) progress(at + n, keys.size());
  }

  // A tile holds its points in the order of the log.
  struct Cursor {
    const std::vector<uint8_t>* flags;
    size_t next = 0;
  };
  std::map<TileKey, Cursor> cursors;
  for (size_t k = 0; k < keys.size(); ++k) cursors[keys[k]] = {&found[k]};
  std::vector<uint8_t> out;
  out.reserve(store.size());
  for_each_hit(source, origin, [&](const Vec3f& point) {
    Cursor& cursor = cursors.at(store.key_of(point));
    out.push_back((*cursor.flags)[cursor.next++]);
  });
  return out;
}

}  // namespace underbrush::ground
