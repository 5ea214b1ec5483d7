#include "underbrush/update/update_work.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "underbrush/calibrate/light.hpp"
#include "underbrush/core/still_beams.hpp"
#include "underbrush/credit/element_classes.hpp"
#include "underbrush/fit/fitters.hpp"
#include "underbrush/fit/tile_fit.hpp"
#include "underbrush/likelihood/likelihood.hpp"
#include "underbrush/trace/world.hpp"
#include "underbrush/update/changed_places.hpp"
#include "underbrush/update/kept_triangles.hpp"
#include "underbrush/update/refitted_area.hpp"

namespace underbrush::update {

UpdateWork::UpdateWork(fit::FitResult& out, UpdateReport& report,
                       const std::vector<BeamSource*>& logs, BeamSource& added,
                       const fit::FitOptions& options, const fit::FitProgress& progress)
    : out_(out),
      model_(out.model),
      report_(report),
      logs_(logs),
      added_(added),
      options_(options),
      progress_(progress),
      ground_(out.model.ground) {}

void UpdateWork::fit(const std::vector<TileKey>& anew) {
  anew_ = anew;
  ellipsoids_ = model_.ellipsoids.size();
  before_.resize(ellipsoids_);
  for (uint32_t k = 0; k < before_.size(); ++k) before_[k] = k;
  if (anew.empty()) return;
  TileOptions tiles = fit::tile_options(options_);
  tiles.tile_m = out_.record.tile_m;
  TileStore store(tiles);
  const fit::TileSet wanted(anew, tiles.tile_m);
  for (BeamSource* log : logs_) gather_near(*log, wanted, store);
  gather_near(added_, wanted, store);
  before_ = fit::fit_tiles(store, anew, options_, out_, progress_);
}

void UpdateWork::count() {
  const std::vector<uint32_t> triangles = kept_triangles(ground_, model_.ground);
  const size_t meshes = model_.triangle_count();
  new_.assign(model_.size(), false);
  std::vector<CurrentTrials> now(model_.size());
  for (size_t i = 0; i < model_.size(); ++i) {
    const elements::HitCount* hit = nullptr;
    if (i >= meshes) {
      if (before_[i - meshes] != fit::kNewEllipsoid) hit = &model_.hit(i);
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
  times_.assign(model_.ellipsoids.size(), {});
  if (!anew_.empty()) count_earlier(world, now);
  credit::Tally tally(model_, options_.credit);
  tally.zero_s = zero_s_;
  tally.add(world, added_, options_.credit, fit::stage_of(progress_, "count hits"));
  add_times(tally);
  add_log(tally.of, now);
  for (size_t i = 0; i < model_.size(); ++i) {
    model_.hit(i) = {1, now[i].trials.hits, now[i].trials.misses};
  }
  credit::estimate_hit_probabilities(model_, options_.credit);
  learn_noise(tally.residuals.ground);
  adapt_densities(before, p_before, std::span(now).subspan(meshes));
  drop(before, std::span(now).subspan(meshes));
}

void UpdateWork::refine_new(const likelihood::LikelihoodOptions& options) {
  if (std::find(new_.begin(), new_.end(), true) == new_.end()) return;
  std::vector<bool> moving = new_;
  // In the tiles that are fitted anew all beams that meet the ground are at hand.
  const std::set<TileKey> anew(anew_.begin(), anew_.end());
  const elements::TriangleMesh& ground = model_.ground;
  for (size_t t = 0; t < ground.size(); ++t) {
    const Vec3f& corner = ground.vertices[ground.triangles[t][0]];
    if (anew.contains(fit::tile_of(corner, out_.record.tile_m))) moving[t] = true;
  }
  with_crossing(
      [&](BeamSource& beams) {
        model_ = likelihood::refine(model_, beams, options, progress_, {moving, out_.open}).model;
      },
      changed_.ellipsoids.empty() ? nullptr : &changed_);
}

void UpdateWork::colour() {
  if (std::find(new_.begin(), new_.end(), true) == new_.end()) return;
  with_crossing([&](BeamSource& beams) {
    credit::learn_classes(model_, beams, new_);
    calibrate::learn_reflectances(model_, beams, new_);
  });
}

void UpdateWork::gather_near(BeamSource& log, const fit::TileSet& wanted, TileStore& store) {
  fit::FitReport counts;
  fit::add_returns(log, model_.origin, options_.min_range_m, &wanted, store, counts, progress_);
}

void UpdateWork::with_crossing(const std::function<void(BeamSource&)>& use,
                               const elements::Model* changed) const {
  const credit::GroundArea area = area_now();
  std::vector<std::unique_ptr<BeamSource>> crossing;
  std::vector<BeamSource*> all;
  for (BeamSource* log : logs_) {
    BeamSource* beams = crossing_of(*log, area, crossing);
    if (changed) {
      crossing.push_back(std::make_unique<credit::BeamsBeside>(
          *beams, *changed, options_.credit.max_residual_for_hit_m));
      beams = crossing.back().get();
    }
    all.push_back(beams);
  }
  all.push_back(&added_);
  credit::JoinedBeams joined(all);
  StillBeams still(joined);
  use(still);
}

credit::GroundArea UpdateWork::area_now() const {
  return refitted_area(model_, before_, anew_, out_.record.tile_m);
}

BeamSource* UpdateWork::crossing_of(BeamSource& log, const credit::GroundArea& area,
                                    std::vector<std::unique_ptr<BeamSource>>& hold) const {
  hold.push_back(std::make_unique<credit::CrossingBeams>(
      log, area, model_.origin, model_.max_range_m, options_.credit.max_residual_for_hit_m));
  return hold.back().get();
}

void UpdateWork::add_log(const std::vector<credit::Trials>& later,
                         std::vector<CurrentTrials>& now) const {
  const size_t meshes = model_.triangle_count();
  for (size_t i = 0; i < meshes; ++i) {
    now[i].trials.hits += later[i].hits;
    now[i].trials.misses += later[i].misses;
  }
  add_trials(model_.ellipsoids, std::span(later).subspan(meshes),
             {options_.free_space_below, options_.free_space_beams},
             std::span(now).subspan(meshes));
}

void UpdateWork::count_earlier(const trace::World& world, std::vector<CurrentTrials>& now) {
  const credit::GroundArea area = area_now();
  for (BeamSource* log : logs_) {
    std::vector<std::unique_ptr<BeamSource>> hold;
    BeamSource* crossing = crossing_of(*log, area, hold);
    credit::Tally tally(model_, options_.credit);
    const auto progress = [&](size_t done, size_t total) {
      traced_ = done;
      if (progress_) progress_("count hits", done, total);
    };
    tally.zero_s = zero_s_;
    tally.add(world, *crossing, options_.credit, progress);
    add_times(tally);
    report_.earlier_beams += std::exchange(traced_, 0);
    for (size_t i = 0; i < now.size(); ++i) {
      if (!new_[i]) tally.of[i] = {};
    }
    add_log(tally.of, now);
  }
}

void UpdateWork::add_times(const credit::Tally& tally) {
  zero_s_ = tally.zero_s;
  for (size_t k = 0; k < times_.size(); ++k) {
    if (new_[model_.triangle_count() + k]) times_[k].add(tally.times[k]);
  }
}

void UpdateWork::learn_noise(credit::MeshResiduals& residuals) {
  std::vector<uint32_t>& all = out_.record.residuals;
  if (!all.empty()) residuals.add(all);
  all = residuals.counts();
  elements::TriangleMesh& ground = model_.ground;
  if (ground_.roughness.empty()) {
    credit::set_noise(ground, residuals, options_.range_noise_m);
    return;
  }
  ground.range_sigma_m = ground_.range_sigma_m;
  ground.roughness_m = ground_.roughness_m;
  ground.roughness.assign(ground.size(), float(ground.roughness_m));
  // Where the ground has risen or sunk it is as rough as it was, until it is refined.
  const std::vector<uint32_t> same_place = kept_triangles(ground_, ground, HUGE_VALF);
  for (size_t k = 0; k < ground.size(); ++k) {
    if (same_place[k] != kNewTriangle) ground.roughness[k] = ground_.roughness[same_place[k]];
  }
}

void UpdateWork::take_over_light(const std::vector<uint32_t>& triangles) {
  model_.ground.light.clear();
  if (ground_.light.empty()) return;
  model_.ground.light.resize(model_.ground.size());
  for (size_t k = 0; k < triangles.size(); ++k) {
    if (triangles[k] != kNewTriangle) model_.ground.light[k] = ground_.light[triangles[k]];
  }
}

std::vector<double> UpdateWork::hit_probabilities() const {
  elements::Model model = model_;
  credit::estimate_hit_probabilities(model, options_.credit);
  std::vector<double> out;
  for (const elements::Ellipsoid& e : model.ellipsoids) out.push_back(double(e.hit.p));
  return out;
}

bool UpdateWork::is_untouched(const elements::Ellipsoid& before,
                              const elements::Ellipsoid& now) const {
  return before.density_per_m > 0 && before.hit.hits == now.hit.hits &&
         before.hit.misses == now.hit.misses;
}

void UpdateWork::adapt_densities(const std::vector<elements::Ellipsoid>& before,
                                 const std::vector<double>& p_before,
                                 std::span<const CurrentTrials> now) {
  const auto depth = [](double p) { return -std::log1p(-std::clamp(p, 1e-3, 0.98)); };
  for (size_t k = 0; k < before.size(); ++k) {
    elements::Ellipsoid& e = model_.ellipsoids[k];
    if (before_[k] == fit::kNewEllipsoid || !(e.density_per_m > 0)) continue;
    if (is_untouched(before[k], e)) {
      e.hit.p = before[k].hit.p;
    } else if (now[k].changed) {
      e.density_per_m *= float(depth(double(e.hit.p)) / depth(p_before[k]));
    }
  }
}

void UpdateWork::drop(const std::vector<elements::Ellipsoid>& before,
                      std::span<const CurrentTrials> now) {
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
    stays[k] = is_untouched(before[k], e) ||
               !(now[k].gone || fit::is_free_space(options_, e.hit, times_[k]));
  }
  fit::keep_ellipsoids(stays, out_);
  std::vector<bool> still_new(new_.begin(), new_.begin() + ptrdiff_t(meshes));
  std::vector<uint32_t> numbers;
  for (size_t k = 0; k < stays.size(); ++k) {
    if (!stays[k]) continue;
    ++(before_[k] == fit::kNewEllipsoid ? report_.added : report_.kept);
    still_new.push_back(new_[meshes + k]);
    numbers.push_back(before_[k]);
  }
  report_.dropped = ellipsoids_ - report_.kept;
  report_.gone = gone.size();
  report_.places = changed_places(gone);
  new_ = std::move(still_new);
  before_ = std::move(numbers);
}

}  // namespace underbrush::update
