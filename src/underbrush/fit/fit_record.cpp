#include "underbrush/fit/fit_record.hpp"

#include <algorithm>

namespace underbrush::fit {

const TileRecord* FitRecord::find(TileKey key) const {
  const auto at = std::lower_bound(tiles.begin(), tiles.end(), key,
                                   [](const TileRecord& t, const TileKey& k) { return t.key < k; });
  return at != tiles.end() && at->key == key ? &*at : nullptr;
}

size_t FitRecord::ellipsoids() const {
  size_t sum = 0;
  for (const TileRecord& t : tiles) sum += t.ellipsoids;
  return sum;
}

}  // namespace underbrush::fit
