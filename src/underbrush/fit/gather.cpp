#include "underbrush/fit/gather.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"

namespace underbrush::fit {
namespace {

/// Adds the points of all returns to the store, and gives the largest range among them, m.
double add_hits(BeamSource& source, const Vec3& origin, double min_range_m, TileStore& store,
                FitReport& report, const FitProgress& progress) {
  float largest = 0;
  source.rewind();
  for (BeamLog chunk; source.next(chunk);) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (!chunk.is_hit(i)) continue;
      ++report.hits;
      if (double(chunk.range_m[i]) < min_range_m) {
        ++report.near_points;
        continue;
      }
      if (chunk.flags[i] & kMover) {
        ++report.mover_points;
        continue;
      }
      largest = std::max(largest, chunk.range_m[i]);
      store.add(
          {(chunk.end_point(i) - origin).cast<float>(), -chunk.range_m[i] * chunk.direction[i]});
    }
    report.beams += chunk.size();
    if (progress) progress("gather", report.beams, source.size());
  }
  report.misses = report.beams - report.hits;
  report.thinned_points = store.thinned();
  report.tiles = store.tiles().size();
  return largest;
}

}  // namespace

void gather(BeamSource& source, const FitOptions& options, TileStore& store, FitResult& out,
            const FitProgress& progress) {
  const std::optional<Vec3> origin = log_origin(source);
  require_data(origin.has_value(), "fit: the log is empty");
  elements::Model& model = out.model;
  model.fitter = options.fitter;
  model.tau = options.tau;
  model.origin = *origin;
  model.max_range_m =
      add_hits(source, model.origin, options.min_range_m, store, out.report, progress);
  require_data(store.size() > 0, "fit: the log has no return to fit a model to");
  if (!source.info().has_misses) {
    out.report.warnings.push_back(
        "the log has no misses, so hit probabilities come out too high; import it with "
        "--infer-misses SENSOR if its format drops them");
  }
}

}  // namespace underbrush::fit
