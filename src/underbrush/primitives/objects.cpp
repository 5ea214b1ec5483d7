#include "underbrush/primitives/objects.hpp"

#include <algorithm>
#include <map>

#include "underbrush/core/check.hpp"
#include "underbrush/primitives/run_groups.hpp"

namespace underbrush::primitives {

struct ObjectFinder::State {
  ObjectOptions o;
  RunGraph graph;
  std::vector<uint32_t> object;  // Object of each run.
  std::vector<FoundObject> objects;

  void number(Groups groups);
};

void ObjectFinder::State::number(Groups groups) {
  const std::vector<Run>& runs = graph.runs();
  struct Sum {
    int32_t x0 = INT32_MAX, x1 = INT32_MIN, y0 = INT32_MAX, y1 = INT32_MIN;
    size_t points = 0;
    std::vector<float> tops;
    uint32_t number = 0;
  };
  std::map<uint32_t, Sum> sums;
  for (uint32_t i = 0; i < runs.size(); ++i) {
    const Run& r = runs[i];
    Sum& s = sums[groups.find(i)];
    s.x0 = std::min(s.x0, r.x), s.x1 = std::max(s.x1, r.x);
    s.y0 = std::min(s.y0, r.y), s.y1 = std::max(s.y1, r.y);
    s.points += r.points;
    s.tops.push_back(r.top_m);
  }
  for (auto& [group, s] : sums) {
    if (s.points < o.min_points) continue;
    // An object is as high as its top, a patch as nine tenths of its columns.
    std::sort(s.tops.begin(), s.tops.end());
    FoundObject found;
    found.points = s.points;
    found.side_m = graph.cell_m() * (std::max(s.x1 - s.x0, s.y1 - s.y0) + 1);
    found.height_m = double(s.tops.back());
    if (is_high(runs[group], o.sizes) && found.height_m >= o.sizes.tree_m) {
      found.label = tree_class(o.sizes, found.height_m);
    } else {
      const bool patch = found.side_m >= o.sizes.patch_m;
      if (patch) found.height_m = double(s.tops[(s.tops.size() - 1) * 9 / 10]);
      found.label = shrub_class(o.sizes, found.height_m, patch);
    }
    objects.push_back(found);
    s.number = uint32_t(objects.size());
  }
  object.resize(runs.size());
  for (uint32_t i = 0; i < runs.size(); ++i) object[i] = sums[groups.find(i)].number;
}

ObjectFinder::ObjectFinder(const ObjectOptions& o) {
  require(o.cell_m >= 0 && o.gap_m >= 0 && o.spacing_a_m >= 0 && o.spacing_b >= 0 &&
              o.prominence_a_m >= 0 && o.prominence_b >= 0 && o.radius_a_m > 0 && o.radius_b >= 0 &&
              o.trunk_m >= 0,
          "objects: lengths must be positive");
  const SizeRules& s = o.sizes;
  require(s.tree_m > 0 && s.small_shrub_m <= s.medium_shrub_m &&
              s.medium_shrub_m <= s.large_shrub_m && s.medium_tree_m <= s.large_tree_m,
          "objects: the sizes' limits must rise from small to large");
  state_ = std::make_unique<State>(State{o, RunGraph(o.cell_m, o.gap_m), {}, {}});
}
ObjectFinder::~ObjectFinder() = default;

void ObjectFinder::add(std::span<const Vec3f> points) { state_->graph.add(points); }

void ObjectFinder::find() {
  state_->graph.build();
  state_->number(group_runs(state_->graph, state_->o));
}

uint32_t ObjectFinder::object_of(const Vec3f& point) const {
  const uint32_t run = state_->graph.run_at(point);
  return run == RunGraph::kNone ? 0 : state_->object[run];
}

const std::vector<FoundObject>& ObjectFinder::objects() const { return state_->objects; }
double ObjectFinder::cell_m() const { return state_->graph.cell_m(); }

}  // namespace underbrush::primitives
