#include "underbrush/update/update.hpp"

#include <algorithm>
#include <memory>

#include "underbrush/calibrate/observed_space.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/still_beams.hpp"
#include "underbrush/fit/fitters.hpp"
#include "underbrush/fit/part_options.hpp"
#include "underbrush/keyframes/keyframe_cache.hpp"
#include "underbrush/update/new_returns.hpp"
#include "underbrush/update/update_work.hpp"

namespace underbrush::update {
namespace {

void check(const fit::FitResult& known, const std::vector<BeamSource*>& logs, BeamSource& added,
           const UpdateOptions& refitting) {
  require(refitting.growth >= 0 && refitting.unexplained >= 0,
          "update: a share must not be negative");
  require(!logs.empty(), "update: the logs of the model are missing");
  require_data(
      !known.record.tiles.empty() && known.record.ellipsoids() == known.model.ellipsoids.size(),
      "the model has no record of its tiles");
  const LogInfo &a = logs.front()->info(), &b = added.info();
  if (a.sensor != b.sensor || a.sensor_file != b.sensor_file) {
    const auto name = [](const LogInfo& i) { return i.sensor.empty() ? "unknown" : i.sensor; };
    throw DataError("the sensor of the scans is " + name(b) + ", that of the model's log is " +
                    name(a));
  }
  const elements::Model& model = known.model;
  require_data(
      !model.keyframes || !model.sensor.empty() || keyframes::KeyframeCache::serves(model, added),
      "the scans are of another sensor than the model's log: neither names it, and their "
      "channels or ranges are others");
}

/// The tiles to fit anew. The record of each other tile receives the counts of its new returns.
std::vector<TileKey> tiles_to_fit(fit::FitRecord& record, const NewReturns& added_returns,
                                  const UpdateOptions& refitting) {
  std::vector<TileKey> out;
  for (const auto& [key, tile] : added_returns.tiles) {
    const fit::TileRecord* known = record.find(key);
    if (!known) {
      out.push_back(key);
      continue;
    }
    fit::TileRecord& changed = record.tiles[size_t(known - record.tiles.data())];
    changed.later += tile.returns;
    changed.unexplained += tile.unexplained;
    const double points = double(changed.points);
    const bool anew = double(changed.later) >= refitting.growth * points ||
                      double(changed.unexplained) >= refitting.unexplained * points;
    if (anew) out.push_back(key);
  }
  return out;
}

void warn(const NewReturns& added_returns, const LogInfo& info, UpdateReport& report) {
  if (!info.has_misses) {
    report.warnings.push_back(
        "the scans have no misses, so hit probabilities come out too high; import them with "
        "--infer-misses SENSOR if their format drops them");
  }
  if (2 * added_returns.unexplained > added_returns.hits) {
    report.warnings.push_back(
        "most returns lie where the model has nothing; are the scans in its frame?");
  }
}

}  // namespace

UpdateResult update(fit::FitResult known, const std::vector<BeamSource*>& logs, BeamSource& added,
                    const fit::FitOptions& options, const UpdateOptions& refitting,
                    const fit::FitProgress& progress) {
  check(known, logs, added, refitting);
  fit::FitOptions start = fit::start_options(options);
  UpdateReport report;
  report.tiles = known.record.tiles.size();
  report.kept = known.model.ellipsoids.size();
  if (added.size() == 0) {
    report.warnings.push_back("there are no new scans: the model stays as it is");
    return {std::move(known.model), std::move(known.record), std::move(report)};
  }
  report.kept = 0;
  std::vector<std::unique_ptr<BeamSource>> corrected;
  std::vector<BeamSource*> earlier;
  for (BeamSource* log : logs) {
    corrected.push_back(std::make_unique<CorrectedBeams>(*log, known.model.channels));
    earlier.push_back(corrected.back().get());
  }
  CorrectedBeams scans(added, known.model.channels);
  if (fit::fitter_named(options.fitter).refines) {
    start.volumetric.spacing = cluster::beam_spacing(scans);
  }
  const NewReturns added_returns = new_returns(scans, known.model, known.record, start, progress);
  warn(added_returns, added.info(), report);
  report.beams = added_returns.beams;
  report.hits = added_returns.hits;
  report.misses = added_returns.beams - added_returns.hits;
  report.mover_points = added_returns.movers;
  report.near_points = added_returns.near;
  report.unexplained = added_returns.unexplained;
  for (const auto& [key, tile] : added_returns.tiles) report.touched_tiles += tile.is_touched;
  RangeCut ranges = added_returns.ranges;
  ranges.add(known.record.last_returns);
  known.record.last_returns = ranges.last();
  known.model.max_range_m = ranges.reach_m();
  const std::vector<TileKey> anew = tiles_to_fit(known.record, added_returns, refitting);
  report.fitted_tiles = anew.size();
  UpdateWork work(known, report, earlier, scans, start, progress);
  work.fit(anew);
  work.count();
  if (fit::fitter_named(options.fitter).refines) work.refine_new(fit::likelihood_options(options));
  work.colour();
  if (fit::fitter_named(options.fitter).refines) {
    StillBeams still(scans);
    report.keyframes = keyframes::update_keyframes(known.model, still,
                                                   fit::keyframe_options(options), work.changed());
    calibrate::update_observed_space(known.model, still, options.min_range_m);
  }
  report.tiles = known.record.tiles.size();
  return {std::move(known.model), std::move(known.record), std::move(report)};
}

}  // namespace underbrush::update
