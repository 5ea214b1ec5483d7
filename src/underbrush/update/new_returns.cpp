#include "underbrush/update/new_returns.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_set>

#include "underbrush/core/check.hpp"
#include "underbrush/credit/explaining.hpp"
#include "underbrush/fit/gather.hpp"

namespace underbrush::update {
namespace {

constexpr double kFarthestM = 1e6;  // coordinates of a model are floats

/// Marks the tiles of a record that lie within the margin of returns.
class Touched {
 public:
  Touched(const fit::FitRecord& record, NewReturns& out) : record_(record), out_(out) {}

  void add(const Vec3f& p) {
    // Tiles are looked up once for each square metre.
    const auto cell = std::pair{int32_t(std::floor(p.x())), int32_t(std::floor(p.y()))};
    if (!seen_.insert(uint64_t(uint32_t(cell.first)) << 32 | uint32_t(cell.second)).second) return;
    const int i0 = key(cell.first - kTileMarginM), i1 = key(cell.first + 1 + kTileMarginM);
    const int j0 = key(cell.second - kTileMarginM), j1 = key(cell.second + 1 + kTileMarginM);
    for (int i = i0; i <= i1; ++i) {
      for (int j = j0; j <= j1; ++j) {
        if (record_.find({i, j})) out_.tiles[{i, j}].is_touched = true;
      }
    }
  }

 private:
  int key(double x) const { return int(std::floor(x / record_.tile_m)); }

  const fit::FitRecord& record_;
  NewReturns& out_;
  std::unordered_set<uint64_t> seen_;
};

/// The distance of a place from the nearest tile, m.
double distance_from(const fit::FitRecord& record, const Vec3& place) {
  double least = INFINITY;
  for (const fit::TileRecord& tile : record.tiles) {
    const Eigen::Vector2d low = record.tile_m * Eigen::Vector2d(tile.key.i, tile.key.j);
    const Eigen::Vector2d past =
        (low - place.head<2>())
            .cwiseMax(place.head<2>() - low - Eigen::Vector2d::Constant(record.tile_m))
            .cwiseMax(0);
    least = std::min(least, past.norm());
  }
  return least;
}

}  // namespace

NewReturns new_returns(BeamSource& added, const elements::Model& model,
                       const fit::FitRecord& record, const fit::FitOptions& options,
                       const fit::FitProgress& progress) {
  NewReturns out;
  const trace::World world(model);
  Touched touched(record, out);
  double nearest_m = INFINITY;
  added.rewind();
  for (BeamLog chunk; added.next(chunk);) {
    for (size_t i = 0; i < chunk.size(); i += 1000) {
      const Vec3 place = chunk.origin[i] - model.origin;
      nearest_m = std::min(nearest_m, distance_from(record, place));
      if (place.norm() > kFarthestM) nearest_m = place.norm();
      if (nearest_m > std::max(chunk.info.max_range_m, kTileMarginM)) {
        throw DataError("the scans lie " + std::to_string(std::llround(nearest_m)) +
                        " m from the model: are they in its frame?");
      }
    }
    const std::vector<uint32_t> element = credit::explaining_elements(world, chunk);
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (!chunk.is_hit(i)) continue;
      ++out.hits;
      if (double(chunk.range_m[i]) < options.min_range_m) {
        ++out.near;
        continue;
      }
      if (chunk.flags[i] & kMover) {
        ++out.movers;
        continue;
      }
      out.ranges.add(chunk.range_m[i]);
      const Vec3f p = (chunk.end_point(i) - model.origin).cast<float>();
      TileReturns& tile = out.tiles[fit::tile_of(p, record.tile_m)];
      ++tile.returns;
      tile.is_touched = true;
      if (element[i] == trace::Intersection::kNone) {
        ++tile.unexplained;
        ++out.unexplained;
      }
      touched.add(p);
    }
    out.beams += chunk.size();
    if (progress) progress("read scans", out.beams, added.size());
  }
  return out;
}

}  // namespace underbrush::update
