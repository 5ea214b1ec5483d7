#include "underbrush/fit/update.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "underbrush/core/check.hpp"
#include "underbrush/core/still_beams.hpp"
#include "underbrush/fit/change.hpp"
#include "underbrush/fit/crossing_beams.hpp"
#include "underbrush/fit/element_classes.hpp"
#include "underbrush/fit/fitters.hpp"
#include "underbrush/fit/gather.hpp"
#include "underbrush/fit/kept_triangles.hpp"
#include "underbrush/fit/light.hpp"
#include "underbrush/fit/new_returns.hpp"
#include "underbrush/fit/tile_fit.hpp"

namespace underbrush::fit {
namespace {

void check(const FitResult& known, const std::vector<BeamSource*>& logs, const BeamSource& added,
           const UpdateOptions& how) {
  require(how.growth >= 0 && how.unexplained >= 0, "update: a share must not be negative");
  require(!logs.empty(), "update: the logs of the model are missing");
  require_data(
      !known.record.tiles.empty() && known.record.ellipsoids() == known.model.ellipsoids.size(),
      "the model has no record of its tiles");
  require_data(!known.model.keyframes,
               "the model has keyframes, which would keep what has gone; fit it without them");
  const LogInfo &a = logs.front()->info(), &b = added.info();
  if (a.sensor != b.sensor || a.sensor_file != b.sensor_file) {
    const auto name = [](const LogInfo& i) { return i.sensor.empty() ? "unknown" : i.sensor; };
    throw DataError("the sensor of the scans is " + name(b) + ", that of the model's log is " +
                    name(a));
  }
}

/// The tiles to fit anew. The record of each other tile receives the counts of its new returns.
std::vector<TileKey> tiles_to_fit(FitRecord& record, const NewReturns& news,
                                  const UpdateOptions& how) {
  std::vector<TileKey> out;
  for (const auto& [key, tile] : news.tiles) {
    const TileRecord* known = record.find(key);
    if (!known) {
      out.push_back(key);
      continue;
    }
    TileRecord& changed = record.tiles[size_t(known - record.tiles.data())];
    changed.later += tile.returns;
    changed.unexplained += tile.unexplained;
    const double points = double(changed.points);
    const bool anew = double(changed.later) >= how.growth * points ||
                      double(changed.unexplained) >= how.unexplained * points;
    if (anew) out.push_back(key);
  }
  return out;
}

/// Where beams may meet what was fitted anew.
GroundArea area_of(const elements::Model& model, const std::vector<uint32_t>& before,
                   const std::vector<TileKey>& anew, double tile_m) {
  const auto corner = [&](TileKey key) { return Eigen::Vector2d(key.i * tile_m, key.j * tile_m); };
  const Eigen::Vector2d side(tile_m, tile_m);
  Eigen::Vector2d low = corner(anew.front()), high = low;
  for (const TileKey key : anew) {
    low = low.cwiseMin(corner(key) - side);
    high = high.cwiseMax(corner(key) + 2 * side);
  }
  GroundArea area(low, high);
  for (const TileKey key : anew) area.add(corner(key), corner(key) + side);
  for (size_t k = 0; k < before.size(); ++k) {
    if (before[k] != kNewEllipsoid) continue;
    const elements::Ellipsoid& e = model.ellipsoids[k];
    const Eigen::Vector2d mean = e.mean.head<2>().cast<double>();
    const Eigen::Vector2d reach =
        model.tau * Eigen::Vector2d(std::sqrt(e.covariance[0]), std::sqrt(e.covariance[3]));
    area.add(mean - reach, mean + reach);
  }
  return area;
}

/// The squares where most of the ellipsoids have gone.
std::vector<ChangedPlace> places_of(const std::vector<Vec3>& gone) {
  constexpr double kSideM = 4;
  constexpr size_t kMost = 10;
  std::map<std::pair<int64_t, int64_t>, ChangedPlace> cells;
  for (const Vec3& at : gone) {
    ChangedPlace& cell =
        cells[{int64_t(std::floor(at.x() / kSideM)), int64_t(std::floor(at.y() / kSideM))}];
    cell.centre += at;
    ++cell.gone;
  }
  std::vector<ChangedPlace> out;
  for (const auto& [key, cell] : cells) out.push_back({cell.centre / double(cell.gone), cell.gone});
  std::stable_sort(out.begin(), out.end(),
                   [](const ChangedPlace& a, const ChangedPlace& b) { return a.gone > b.gone; });
  if (out.size() > kMost) out.resize(kMost);
  return out;
}

/// The beams of a log that meet none of some ellipsoids.
class BeamsBeside : public BeamSource {
 public:
  /// `model` has the ellipsoids and nothing else. Both must outlive the beams.
  BeamsBeside(BeamSource& source, const elements::Model& model) : source_(source), world_(model) {}
  const LogInfo& info() const override { return source_.info(); }
  /// The number of beams of the source.
  size_t size() const override { return source_.size(); }
  void rewind() override { source_.rewind(); }
  bool next(BeamLog& chunk) override {
    for (BeamLog all; source_.next(all);) {
      std::vector<Ray> rays;
      for (size_t i = 0; i < all.size(); ++i) rays.push_back(all.ray(i));
      const std::vector<double> reach(rays.size(), HUGE_VAL);
      trace::IntersectionLists met;
      world_.all_intersections(rays, {0, all.info.max_range_m}, reach, met);
      chunk = all.like();
      for (size_t i = 0; i < all.size(); ++i) {
        if (met[i].empty()) chunk.append(all, i);
      }
      if (!chunk.empty()) return true;
    }
    return false;
  }

 private:
  BeamSource& source_;
  trace::World world_;
};

/// The work of one update.
class Update {
 public:
  Update(FitResult& out, UpdateReport& report, const std::vector<BeamSource*>& logs,
         BeamSource& added, const FitOptions& options, const FitProgress& progress)
      : out_(out),
        model_(out.model),
        report_(report),
        logs_(logs),
        added_(added),
        options_(options),
        progress_(progress),
        ground_(out.model.ground) {}

  void fit(const std::vector<TileKey>& anew) {
    anew_ = anew;
    ellipsoids_ = model_.ellipsoids.size();
    before_.resize(ellipsoids_);
    for (uint32_t k = 0; k < before_.size(); ++k) before_[k] = k;
    if (anew.empty()) return;
    TileOptions tiles = tile_options(options_);
    tiles.tile_m = out_.record.tile_m;
    TileStore store(tiles);
    const TileSet wanted(anew, tiles.tile_m);
    for (BeamSource* log : logs_) gather_near(*log, wanted, store);
    gather_near(added_, wanted, store);
    before_ = fit_tiles(store, anew, options_, out_, progress_);
  }

  /// Counts the hits and misses of all elements, and drops what is free space.
  void count() {
    const std::vector<uint32_t> triangles = kept_triangles(ground_, model_.ground);
    const size_t meshes = model_.triangle_count();
    new_.assign(model_.size(), false);
    std::vector<CurrentTrials> now(model_.size());
    for (size_t i = 0; i < model_.size(); ++i) {
      const elements::HitCount* hit = nullptr;
      if (i >= meshes) {
        if (before_[i - meshes] != kNewEllipsoid) hit = &model_.hit(i);
      } else if (triangles[i] != kNewTriangle) {
        hit = &ground_.hit[triangles[i]];
      }
      if (hit) now[i].trials = {hit->hits, hit->misses};
      new_[i] = !hit;
    }
    take_over_light(triangles);
    const std::vector<elements::Ellipsoid> before = model_.ellipsoids;
    const std::vector<double> p_before = hit_probabilities();
    for (size_t i = 0; i < model_.size(); ++i) model_.hit(i) = {1, 0, 0};
    const trace::World world(model_);
    if (!anew_.empty()) count_earlier(world, now);
    Tally tally(model_, options_.credit);
    tally.add(world, added_, options_.credit, stage_of(progress_, "count hits"));
    add_log(tally.of, now);
    for (size_t i = 0; i < model_.size(); ++i) {
      model_.hit(i) = {1, now[i].trials.hits, now[i].trials.misses};
    }
    estimate_hit_probabilities(model_, options_.credit);
    learn_noise(tally.residuals.ground);
    adapt_densities(before, p_before, std::span(now).subspan(meshes));
    drop(before, std::span(now).subspan(meshes));
  }

  /// Refines the new ellipsoids as `likelihood` does, with the beams that may meet them. Earlier
  /// beams through what has changed saw another world.
  void refine_new(const LikelihoodOptions& options) {
    const std::vector<bool> moving(new_.begin() + ptrdiff_t(model_.triangle_count()), new_.end());
    if (std::find(moving.begin(), moving.end(), true) == moving.end()) return;
    with_crossing(
        [&](BeamSource& beams) {
          model_ = refine(model_, beams, options, progress_, moving).model;
        },
        changed_.ellipsoids.empty() ? nullptr : &changed_);
  }

  /// Learns the classes and the reflectances of new elements.
  void colour() {
    if (std::find(new_.begin(), new_.end(), true) == new_.end()) return;
    with_crossing([&](BeamSource& beams) {
      learn_classes(model_, beams, new_);
      learn_reflectances(model_, beams, new_);
    });
  }

 private:
  void gather_near(BeamSource& log, const TileSet& wanted, TileStore& store) {
    FitReport counts;
    add_returns(log, model_.origin, options_.min_range_m, &wanted, store, counts, progress_);
  }

  /// Calls `use` with the new beams and those of the earlier logs that may meet what is new, but
  /// none of the ellipsoids of `changed` if that is not null.
  void with_crossing(const std::function<void(BeamSource&)>& use,
                     const elements::Model* changed = nullptr) const {
    const GroundArea area = area_now();
    std::vector<std::unique_ptr<BeamSource>> crossing;
    std::vector<BeamSource*> all;
    for (BeamSource* log : logs_) {
      BeamSource* beams = crossing_of(*log, area, crossing);
      if (changed) {
        crossing.push_back(std::make_unique<BeamsBeside>(*beams, *changed));
        beams = crossing.back().get();
      }
      all.push_back(beams);
    }
    all.push_back(&added_);
    JoinedBeams joined(all);
    StillBeams still(joined);
    use(still);
  }

  GroundArea area_now() const { return area_of(model_, before_, anew_, out_.record.tile_m); }

  BeamSource* crossing_of(BeamSource& log, const GroundArea& area,
                          std::vector<std::unique_ptr<BeamSource>>& hold) const {
    hold.push_back(std::make_unique<CrossingBeams>(log, area, model_.origin, model_.max_range_m,
                                                   options_.credit.max_residual_for_hit_m));
    return hold.back().get();
  }

  /// Adds the trials of one more log. Triangles are opaque and do not go.
  void add_log(const std::vector<Trials>& later, std::vector<CurrentTrials>& now) const {
    const size_t meshes = model_.triangle_count();
    for (size_t i = 0; i < meshes; ++i) {
      now[i].trials.hits += later[i].hits;
      now[i].trials.misses += later[i].misses;
    }
    add_trials(model_.ellipsoids, std::span(later).subspan(meshes),
               {options_.free_space_below, options_.free_space_beams},
               std::span(now).subspan(meshes));
  }

  /// Counts the beams of the earlier logs for the elements that are new.
  void count_earlier(const trace::World& world, std::vector<CurrentTrials>& now) {
    const GroundArea area = area_now();
    for (BeamSource* log : logs_) {
      std::vector<std::unique_ptr<BeamSource>> hold;
      BeamSource* crossing = crossing_of(*log, area, hold);
      Tally tally(model_, options_.credit);
      const auto progress = [&](size_t done, size_t total) {
        traced_ = done;
        if (progress_) progress_("count hits", done, total);
      };
      tally.add(world, *crossing, options_.credit, progress);
      report_.earlier_beams += std::exchange(traced_, 0);
      for (size_t i = 0; i < now.size(); ++i) {
        if (!new_[i]) tally.of[i] = {};
      }
      add_log(tally.of, now);
    }
  }

  /// The noise of the ground is that of all returns so far.
  void learn_noise(MeshResiduals& residuals) {
    std::vector<uint32_t>& all = out_.record.residuals;
    if (!all.empty()) residuals.add(all);
    all = residuals.counts();
    set_noise(model_.ground, residuals, options_.range_noise_m);
  }

  void take_over_light(const std::vector<uint32_t>& triangles) {
    model_.ground.light.clear();
    if (ground_.light.empty()) return;
    model_.ground.light.resize(model_.ground.size());
    for (size_t k = 0; k < triangles.size(); ++k) {
      if (triangles[k] != kNewTriangle) model_.ground.light[k] = ground_.light[triangles[k]];
    }
  }

  /// The hit probabilities of the ellipsoids by their counts.
  std::vector<double> hit_probabilities() const {
    elements::Model model = model_;
    estimate_hit_probabilities(model, options_.credit);
    std::vector<double> out;
    for (const elements::Ellipsoid& e : model.ellipsoids) out.push_back(double(e.hit.p));
    return out;
  }

  /// Whether an ellipsoid with a density has the counts that it had before.
  bool is_untouched(const elements::Ellipsoid& before, const elements::Ellipsoid& now) const {
    return before.density_per_m > 0 && before.hit.hits == now.hit.hits &&
           before.hit.misses == now.hit.misses;
  }

  /// The optical depth −ln(1 − p) of a kept ellipsoid that has changed does so as that of its
  /// counts.
  void adapt_densities(const std::vector<elements::Ellipsoid>& before,
                       const std::vector<double>& p_before, std::span<const CurrentTrials> now) {
    const auto depth = [](double p) { return -std::log1p(-std::clamp(p, 1e-3, 0.98)); };
    for (size_t k = 0; k < before.size(); ++k) {
      elements::Ellipsoid& e = model_.ellipsoids[k];
      if (before_[k] == kNewEllipsoid || !(e.density_per_m > 0)) continue;
      if (is_untouched(before[k], e)) {
        e.hit.p = before[k].hit.p;
      } else if (now[k].changed) {
        e.density_per_m *= float(depth(double(e.hit.p)) / depth(p_before[k]));
      }
    }
  }

  void drop(const std::vector<elements::Ellipsoid>& before, std::span<const CurrentTrials> now) {
    const size_t meshes = model_.triangle_count();
    std::vector<Vec3> gone;
    for (size_t k = 0; k < now.size(); ++k) {
      report_.changed += now[k].changed;
      if (!now[k].changed || !now[k].gone) continue;
      gone.push_back(model_.origin + model_.ellipsoids[k].mean.cast<double>());
    }
    changed_.origin = model_.origin;
    changed_.tau = model_.tau;
    changed_.max_range_m = model_.max_range_m;
    std::vector<bool> stays(now.size());
    for (size_t k = 0; k < now.size(); ++k) {
      const elements::Ellipsoid& e = model_.ellipsoids[k];
      if (now[k].changed) changed_.ellipsoids.push_back(e);
      stays[k] = is_untouched(before[k], e) || !(now[k].gone || is_free_space(options_, e.hit));
    }
    keep_ellipsoids(stays, model_, out_.record);
    std::vector<bool> still_new(new_.begin(), new_.begin() + ptrdiff_t(meshes));
    std::vector<uint32_t> numbers;
    for (size_t k = 0; k < stays.size(); ++k) {
      if (!stays[k]) continue;
      ++(before_[k] == kNewEllipsoid ? report_.added : report_.kept);
      still_new.push_back(new_[meshes + k]);
      numbers.push_back(before_[k]);
    }
    report_.dropped = ellipsoids_ - report_.kept;
    report_.gone = gone.size();
    report_.places = places_of(gone);
    new_ = std::move(still_new);
    before_ = std::move(numbers);
  }

  FitResult& out_;
  elements::Model& model_;
  UpdateReport& report_;
  const std::vector<BeamSource*>& logs_;
  BeamSource& added_;
  const FitOptions& options_;
  const FitProgress& progress_;
  const elements::TriangleMesh ground_;  // as it was
  std::vector<TileKey> anew_;
  std::vector<uint32_t> before_;  // of each ellipsoid, its number in the model as it was
  std::vector<bool> new_;         // of each element, whether it is new
  elements::Model changed_;       // the ellipsoids of which later beams say otherwise
  size_t ellipsoids_ = 0, traced_ = 0;
};

void warn(const NewReturns& news, const LogInfo& info, UpdateReport& report) {
  if (!info.has_misses) {
    report.warnings.push_back(
        "the scans have no misses, so hit probabilities come out too high; import them with "
        "--infer-misses SENSOR if their format drops them");
  }
  if (2 * news.unexplained > news.hits) {
    report.warnings.push_back(
        "most returns lie where the model has nothing; are the scans in its frame?");
  }
}

}  // namespace

UpdateResult update(FitResult known, const std::vector<BeamSource*>& logs, BeamSource& added,
                    const FitOptions& options, const UpdateOptions& how,
                    const FitProgress& progress) {
  check(known, logs, added, how);
  const FitOptions start = start_options(options);
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
  const NewReturns news = new_returns(scans, known.model, known.record, start, progress);
  warn(news, added.info(), report);
  report.beams = news.beams;
  report.hits = news.hits;
  report.misses = news.beams - news.hits;
  report.mover_points = news.movers;
  report.near_points = news.near;
  report.unexplained = news.unexplained;
  for (const auto& [key, tile] : news.tiles) report.touched_tiles += tile.is_touched;
  known.model.max_range_m = std::max(known.model.max_range_m, news.largest_m);
  const std::vector<TileKey> anew = tiles_to_fit(known.record, news, how);
  report.fitted_tiles = anew.size();
  Update work(known, report, earlier, scans, start, progress);
  work.fit(anew);
  work.count();
  if (fitter_named(options.fitter).refines) work.refine_new(likelihood_options(options));
  work.colour();
  report.tiles = known.record.tiles.size();
  return {std::move(known.model), std::move(known.record), std::move(report)};
}

}  // namespace underbrush::fit
