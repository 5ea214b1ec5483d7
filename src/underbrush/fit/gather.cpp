#include "underbrush/fit/gather.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/range_unit.hpp"

namespace underbrush::fit {

TileKey tile_of(const Vec3f& point, double tile_m) {
  return {int32_t(std::floor(point.x() / tile_m)), int32_t(std::floor(point.y() / tile_m))};
}

TileSet::TileSet(const std::vector<TileKey>& tiles, double tile_m)
    : tile_m_(tile_m), tiles_(tiles.begin(), tiles.end()) {}

bool TileSet::is_near(const Vec3f& point) const {
  const auto key = [&](double x) { return int32_t(std::floor(x / tile_m_)); };
  const TileKey low{key(point.x() - kTileMarginM), key(point.y() - kTileMarginM)};
  const TileKey high{key(point.x() + kTileMarginM), key(point.y() + kTileMarginM)};
  for (int32_t i = low.i; i <= high.i; ++i) {
    const auto at = tiles_.lower_bound({i, low.j});
    if (at != tiles_.end() && at->i == i && at->j <= high.j) return true;
  }
  return false;
}

constexpr double kBeyond = 1.001, kManyFar = 0.01;  // of the maximum range, of the returns

RangeCut add_returns(BeamSource& source, const Vec3& origin, double min_range_m,
                     const TileSet* wanted, TileStore& store, FitReport& report,
                     const FitProgress& progress) {
  RangeCut ranges;
  source.rewind();
  std::vector<Vec3f> points;
  for (BeamLog chunk; source.next(chunk);) {
    points.resize(chunk.size());
    parallel_for(chunk.size(), 4096, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        points[i] = (chunk.end_point(i) - origin).cast<float>();
      }
    });
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (!chunk.is_hit(i)) continue;
      ++report.hits;
      report.far_points += double(chunk.range_m[i]) > kBeyond * source.info().max_range_m;
      if (double(chunk.range_m[i]) < min_range_m) {
        ++report.near_points;
        continue;
      }
      if (chunk.flags[i] & kMover) {
        ++report.mover_points;
        continue;
      }
      ranges.add(chunk.range_m[i]);
      if (wanted && !wanted->is_near(points[i])) continue;
      store.add({points[i], -chunk.range_m[i] * chunk.direction[i]});
    }
    report.beams += chunk.size();
    if (progress) progress("gather", report.beams, source.size());
  }
  report.misses = report.beams - report.hits;
  report.thinned_points = store.thinned();
  report.tiles = store.tiles().size();
  return ranges;
}

void gather(BeamSource& source, const FitOptions& options, TileStore& store, FitResult& out,
            const FitProgress& progress) {
  const std::optional<Vec3> origin = log_origin(source);
  require_data(origin.has_value(), "fit: the log is empty");
  require_metres(source, "fit");
  elements::Model& model = out.model;
  model.fitter = options.fitter;
  model.tau = options.tau;
  model.origin = *origin;
  const RangeCut ranges =
      add_returns(source, model.origin, options.min_range_m, nullptr, store, out.report, progress);
  model.max_range_m = ranges.reach_m();
  out.record.last_returns = ranges.last();
  require_data(store.size() > 0, "fit: the log has no return to fit a model to");
  const FitReport& report = out.report;
  if (double(report.far_points) > kManyFar * double(report.hits)) {
    out.report.warnings.push_back(
        std::to_string(report.far_points) + " of " + std::to_string(report.hits) +
        " returns are beyond the log's maximum range of " +
        std::to_string(int(source.info().max_range_m)) +
        " m, and hit probabilities are learnt without them: import it with another --max-range");
  }
  if (!source.info().has_misses) {
    out.report.warnings.push_back(
        "the log has no misses, so hit probabilities come out too high; import it with "
        "--infer-misses SENSOR if its format drops them");
  }
}

}  // namespace underbrush::fit
