#include "underbrush/actors/learn_actors.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "underbrush/actors/actor_beams.hpp"
#include "underbrush/actors/mirror.hpp"
#include "underbrush/perception/perceive_options.hpp"

namespace underbrush::actors {
namespace {

using perception::ObjectClass;

size_t returns_of(const std::vector<View>& views) {
  size_t sum = 0;
  for (const View& v : views) sum += v.returns;
  return sum;
}

bool is_symmetric(ObjectClass label) {
  return label == ObjectClass::kCar || label == ObjectClass::kVan || label == ObjectClass::kTruck ||
         label == ObjectClass::kCyclist;
}

/// Divides the views of something that changes its shape into parts of at least `least_s`, each
/// with enough returns.
std::vector<std::vector<View>> parts_of(std::vector<View> views, double least_s,
                                        size_t least_returns) {
  std::vector<std::vector<View>> parts(1);
  for (View& v : views) {
    std::vector<View>& last = parts.back();
    const bool is_full = last.size() > 1 && v.time_s - last.front().time_s >= least_s &&
                         returns_of(last) >= least_returns;
    if (is_full) parts.emplace_back();
    parts.back().push_back(std::move(v));
  }
  if (parts.size() > 1 && (parts.back().size() < 2 || returns_of(parts.back()) < least_returns)) {
    std::vector<View> rest = std::move(parts.back());
    parts.pop_back();
    std::ranges::move(rest, std::back_inserter(parts.back()));
  }
  return parts;
}

/// Learns the actor of one track.
class OneActor {
 public:
  OneActor(const Track& track, const ActorOptions& options, const FitActor& fit)
      : track_(track), options_(options), fit_(fit) {}

  void learn(std::vector<View> views, LearntActors& out) const {
    ActorReport report;
    report.name = track_.name();
    report.label = perception::name(track_.label);
    report.scans = views.size();
    report.returns = returns_of(views);
    for (const View& v : views) report.passed += v.beams.size() - v.returns;
    if (views.size() > 1 && report.returns >= options_.least_returns) {
      add_models(std::move(views), report, out.actors);
    }
    out.report.push_back(std::move(report));
  }

 private:
  void add_models(std::vector<View> views, ActorReport& report, std::vector<Actor>& actors) const {
    std::vector<std::vector<View>> parts;
    if (track_.label == ObjectClass::kPedestrian) {
      parts = parts_of(std::move(views), options_.walk_s, options_.least_returns);
    } else {
      parts.push_back(std::move(views));
    }
    std::vector<View> all;
    for (std::vector<View>& part : parts) {
      if (!options_.poses_as_given) report.views = register_views(part, options_.registration);
      std::ranges::copy(part, std::back_inserter(all));
    }
    const Trajectory path = trajectory_of(all);
    double from_s = path.poses().front().time_s;
    for (size_t k = 0; k < parts.size(); ++k) {
      const double to_s =
          k + 1 < parts.size() ? middle_s(parts[k], parts[k + 1]) : path.poses().back().time_s;
      actors.push_back(
          {report.name, report.label, model_of(parts[k], path, report), path, from_s, to_s});
      from_s = to_s;
    }
    report.models = parts.size();
  }

  static double middle_s(const std::vector<View>& a, const std::vector<View>& b) {
    return (a.back().time_s + b.front().time_s) / 2;
  }

  elements::Model model_of(const std::vector<View>& views, const Trajectory& path,
                           ActorReport& report) const {
    const BeamLog beams = in_actor_frame(views, path);
    elements::Model model = at_zero(fit_(beams));
    if (is_symmetric(track_.label) && !options_.one_sided) {
      report.mirrored += complete_by_symmetry(beams, model);
    }
    model.max_range_m = std::numeric_limits<double>::infinity();
    return model;
  }

  const Track& track_;
  const ActorOptions& options_;
  const FitActor& fit_;
};

}  // namespace

std::span<const Option<ActorOptions>> actor_options() {
  using O = ActorOptions;
  // clang-format off
  static const Option<O> kOptions[] = {
    {"boxes-elevation-deg", "", "", perception::kElevationHelp,
     [](O& o) -> auto& { return o.boxes_elevation_deg; }, -90, 90},
    {"margin", "", "m", 
     "Distance outside a box up to which returns belong to the object of the box",
     [](O& o) -> auto& { return o.boxes.margin_m; }, 0, 5},
    {"foot", "", "m",
     "Height above the bottom of a box up to which returns are those of the ground",
     [](O& o) -> auto& { return o.boxes.foot_m; }, 0, 5},
    {"least-returns", "", "", "Leave out objects with fewer returns in all scans",
     [](O& o) -> auto& { return o.least_returns; }, 10, 1e6},
    {"walk", "", "s",
     "Time for which a pedestrian is treated as rigid; each such part of a walk has its own model",
     [](O& o) -> auto& { return o.walk_s; }, 0.05, 1e6},
    {"poses-as-given", "", "", "Keep the poses of the boxes instead of registering the scans of an object",
     [](O& o) -> auto& { return o.poses_as_given; }},
    {"one-sided", "", "", "Leave the unseen side of vehicles and cyclists empty instead of mirroring the other side",
     [](O& o) -> auto& { return o.one_sided; }},
  };
// clang-format on
return kOptions;
}

LearntActors learn_actors(BeamSource& log, const std::vector<Track>& tracks,
                          const ActorOptions& options, const FitActor& fit,
                          const std::function<void(size_t, size_t)>& progress) {
  check_options("actors", actor_options(), options);
  std::vector<std::vector<View>> views = views_of(log, tracks, options.boxes);
  LearntActors out;
  for (size_t k = 0; k < tracks.size(); ++k) {
    OneActor(tracks[k], options, fit).learn(std::move(views[k]), out);
    if (progress) progress(k + 1, tracks.size());
  }
  return out;
}

size_t mark_returns(BoxesOfBeams& boxes, BeamLog& chunk) {
  size_t marked = 0;
  for (size_t i = 0; i < chunk.size(); ++i) {
    if (!boxes.track_of_return(chunk, i)) continue;
    chunk.flags[i] |= kMover;
    ++marked;
  }
  return marked;
}

BeamLog beams_on(BoxesOfBeams& boxes, const BeamLog& chunk) {
  BeamLog out = chunk.like();
  std::vector<size_t> met;
  for (size_t i = 0; i < chunk.size(); ++i) {
    boxes.tracks_on(chunk, i, met);
    if (!met.empty()) out.append(chunk, i);
  }
  return out;
}

}  // namespace underbrush::actors
