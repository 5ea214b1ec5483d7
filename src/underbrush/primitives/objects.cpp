#include "underbrush/primitives/objects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <tuple>

#include "underbrush/core/check.hpp"

namespace underbrush::primitives {
namespace {

constexpr double kBaseM = 0.2;    // side of the columns that points are gathered in
constexpr double kLayerM = 0.2;   // height of a bin
constexpr double kSparseM = 0.5;  // columns wider than this hold a scan from far above
constexpr uint32_t kNone = UINT32_MAX;

struct Bin {
  int32_t y, x, z;
  uint32_t points;
  float top_m;
};
bool before(const Bin& a, const Bin& b) {
  return std::tie(a.y, a.x, a.z) < std::tie(b.y, b.x, b.z);
}

// Sorts and adds up bins of one place.
void merge(std::vector<Bin>& bins) {
  std::sort(bins.begin(), bins.end(), before);
  size_t n = 0;
  for (const Bin& b : bins) {
    if (n && !before(bins[n - 1], b)) {
      bins[n - 1].points += b.points;
      bins[n - 1].top_m = std::max(bins[n - 1].top_m, b.top_m);
    } else {
      bins[n++] = b;
    }
  }
  bins.resize(n);
}

int32_t floor_div(int32_t a, int32_t b) { return (a >= 0 ? a : a - b + 1) / b; }

/// Points of one column without an empty gap.
struct Run {
  int32_t y, x, low, high;  // bins, both included
  uint32_t points;
  float top_m;     // above the ground
  float smooth_m;  // of the tops around
};

/// Union-find; the root of a group is its member that came first.
struct Groups {
  std::vector<uint32_t> parent;
  explicit Groups(size_t n) : parent(n) { std::iota(parent.begin(), parent.end(), 0u); }
  uint32_t find(uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  }
};

}  // namespace

struct ObjectFinder::State {
  ObjectOptions o;
  double cell_m = 0;
  int32_t cells = 1;  // base columns along a side of a column
  double gap_m = 0;
  std::vector<Bin> bins;
  size_t merged = 0;
  std::vector<Run> runs;
  int32_t first_row = 0;
  std::vector<uint32_t> row_begin;
  std::vector<uint32_t> object;  // of each run
  std::vector<FoundObject> objects;

  double base_m() const { return o.cell_m > 0 ? o.cell_m : kBaseM; }

  std::span<const Run> column(int32_t x, int32_t y) const {
    const int64_t row = int64_t(y) - first_row;
    if (row < 0 || row + 1 >= int64_t(row_begin.size())) return {};
    const auto begin = runs.begin() + row_begin[size_t(row)];
    const auto end = runs.begin() + row_begin[size_t(row) + 1];
    const auto less = [](const Run& r, int32_t at) { return r.x < at; };
    const auto more = [](int32_t at, const Run& r) { return at < r.x; };
    const auto from = std::lower_bound(begin, end, x, less);
    return {from, std::upper_bound(from, end, x, more)};
  }

  /// Calls f(j) for each run j beside run i within the gap in height.
  template <class F>
  void for_each_neighbour(uint32_t i, const F& f) const {
    const Run& r = runs[i];
    const auto gap = int32_t(std::lround(gap_m / kLayerM));
    for (int32_t dy = -1; dy <= 1; ++dy) {
      for (int32_t dx = -1; dx <= 1; ++dx) {
        if (dx == 0 && dy == 0) continue;
        for (const Run& other : column(r.x + dx, r.y + dy)) {
          if (other.low - r.high <= gap && r.low - other.high <= gap) {
            f(uint32_t(&other - runs.data()));
          }
        }
      }
    }
  }

  double distance_m(const Run& a, const Run& b) const {
    return cell_m * std::hypot(double(a.x) - b.x, double(a.y) - b.y);
  }
  /// Tall enough to be part of a crown.
  bool is_high(const Run& r) const { return double(r.top_m) >= 0.7 * o.sizes.tree_m; }

  void choose_cell();
  void make_runs();
  void smooth();
  void flood(Groups& groups) const;
  void join_low(Groups& groups) const;
  void adopt(Groups& groups, bool trees) const;
  void hem(Groups& groups) const;
  void number(Groups& groups);
};

// A column should hold two points or more where there are any.
void ObjectFinder::State::choose_cell() {
  cells = 1;
  if (o.cell_m <= 0 && !bins.empty()) {
    std::map<std::array<int32_t, 2>, uint32_t> square;  // of 1 m
    for (const Bin& b : bins) square[{floor_div(b.y, 5), floor_div(b.x, 5)}] += b.points;
    std::vector<uint32_t> counts;
    for (const auto& [at, n] : square) counts.push_back(n);
    std::nth_element(counts.begin(), counts.begin() + long(counts.size() / 2), counts.end());
    const double per_m2 = counts[counts.size() / 2];
    cells = int32_t(std::clamp(std::round(std::sqrt(2 / per_m2) / kBaseM), 2.0, 5.0));
  }
  cell_m = base_m() * cells;
  gap_m = o.gap_m > 0 ? o.gap_m : cell_m < kSparseM ? 1 : 12;
  for (Bin& b : bins) b.x = floor_div(b.x, cells), b.y = floor_div(b.y, cells);
  merge(bins);
}

void ObjectFinder::State::make_runs() {
  const auto gap = int32_t(std::lround(gap_m / kLayerM));
  for (const Bin& b : bins) {
    if (runs.empty() || runs.back().y != b.y || runs.back().x != b.x ||
        b.z - runs.back().high > gap) {
      runs.push_back({b.y, b.x, b.z, b.z, 0, 0, 0});
    }
    runs.back().high = b.z;
    runs.back().points += b.points;
    runs.back().top_m = b.top_m;
  }
  bins = {};
  if (runs.empty()) return;
  first_row = runs.front().y;
  row_begin.assign(size_t(runs.back().y - first_row) + 2, 0);
  for (const Run& r : runs) ++row_begin[size_t(r.y - first_row) + 1];
  std::partial_sum(row_begin.begin(), row_begin.end(), row_begin.begin());
}

// Tops averaged with the higher ones around, so that neither a leaf is a peak nor a hole a pit.
void ObjectFinder::State::smooth() {
  constexpr double kHigher = 0.4;
  std::vector<float> tops;
  for (uint32_t i = 0; i < runs.size(); ++i) {
    if (!is_high(runs[i])) continue;
    tops.assign(1, runs[i].top_m);
    for_each_neighbour(i, [&](uint32_t j) {
      if (is_high(runs[j])) tops.push_back(runs[j].top_m);
    });
    std::sort(tops.begin(), tops.end(), std::greater<>());
    const auto n = std::max<size_t>(1, size_t(kHigher * double(tops.size())));
    float sum = runs[i].top_m;
    for (size_t k = 0; k < n; ++k) sum += tops[k];
    runs[i].smooth_m = sum / float(n + 1);
  }
}

// From the highest run down. The root of a crown's group is its peak.
void ObjectFinder::State::flood(Groups& groups) const {
  std::vector<uint32_t> order;
  for (uint32_t i = 0; i < runs.size(); ++i) {
    if (is_high(runs[i])) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return runs[a].smooth_m > runs[b].smooth_m; });
  std::vector<uint8_t> wet(runs.size(), 0);
  std::vector<uint32_t> crowns;
  const double shallow = cell_m < kSparseM ? 1 : 0.5;  // wide columns smooth dips away
  for (const uint32_t i : order) {
    crowns.clear();
    uint32_t best = kNone;
    float highest = -1;
    for_each_neighbour(i, [&](uint32_t j) {
      if (!wet[j]) return;
      const uint32_t peak = groups.find(j);
      if (std::find(crowns.begin(), crowns.end(), peak) == crowns.end()) crowns.push_back(peak);
      const double reach = o.radius_a_m + o.radius_b * double(runs[peak].top_m);
      if (runs[j].smooth_m > highest && distance_m(runs[peak], runs[i]) <= reach) {
        highest = runs[j].smooth_m;
        best = peak;
      }
    });
    wet[i] = 1;
    if (best == kNone) continue;
    groups.parent[i] = best;
    for (uint32_t other : crowns) {
      best = groups.find(i);
      other = groups.find(other);
      if (other == best) continue;
      const bool lower = runs[other].smooth_m < runs[best].smooth_m ||
                         (runs[other].smooth_m == runs[best].smooth_m && other > best);
      const uint32_t low = lower ? other : best, high = lower ? best : other;
      const double h = double(runs[low].top_m), apart = distance_m(runs[low], runs[high]);
      const double dip = double(runs[low].smooth_m - runs[i].smooth_m);
      if (apart < o.spacing_a_m + o.spacing_b * h ||
          (dip < shallow * (o.prominence_a_m + o.prominence_b * h) &&
           apart < o.radius_a_m + o.radius_b * h)) {
        groups.parent[low] = high;
      }
    }
  }
}

// What is lower becomes connected groups.
void ObjectFinder::State::join_low(Groups& groups) const {
  for (uint32_t i = 0; i < runs.size(); ++i) {
    if (is_high(runs[i])) continue;
    for_each_neighbour(i, [&](uint32_t j) {
      if (is_high(runs[j])) return;
      const uint32_t a = groups.find(i), b = groups.find(j);
      if (a != b) groups.parent[std::max(a, b)] = std::min(a, b);
    });
  }
}

// Narrow groups, trees' own or others, with most of their columns below, above or beside another
// crown join it: feet, trunks that end in the shade of the scan, tips that stand apart.
void ObjectFinder::State::adopt(Groups& groups, bool trees) const {
  struct Extent {
    int32_t x0 = INT32_MAX, x1 = INT32_MIN, y0 = INT32_MAX, y1 = INT32_MIN;
    std::map<uint32_t, uint32_t> crowns;  // how often each was seen
    uint32_t columns = 0, covered = 0;
  };
  const int32_t reach = trees ? 0 : 1;  // a tree needs the crown in its very columns
  std::map<uint32_t, Extent> extents;
  for (uint32_t i = 0; i < runs.size(); ++i) {
    const Run& r = runs[i];
    if (is_high(runs[i]) != trees) continue;
    const uint32_t group = groups.find(i);
    Extent& e = extents[group];
    e.x0 = std::min(e.x0, r.x), e.x1 = std::max(e.x1, r.x);
    e.y0 = std::min(e.y0, r.y), e.y1 = std::max(e.y1, r.y);
    ++e.columns;
    bool covered = false;
    for (int32_t dy = -reach; dy <= reach; ++dy) {
      for (int32_t dx = -reach; dx <= reach; ++dx) {
        for (const Run& other : column(r.x + dx, r.y + dy)) {
          const auto j = uint32_t(&other - runs.data());
          if (!is_high(runs[j]) || groups.find(j) == group) continue;
          ++e.crowns[groups.find(j)];
          covered = true;
        }
      }
    }
    e.covered += covered;
  }
  const double narrow = std::max(o.trunk_m, 2 * cell_m);
  for (const auto& [group, e] : extents) {
    const double side = cell_m * (std::max(e.x1 - e.x0, e.y1 - e.y0) + 1);
    if (e.crowns.empty() || side > narrow + 1e-9 || 2 * e.covered < e.columns) continue;
    const auto most =
        std::max_element(e.crowns.begin(), e.crowns.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    const uint32_t crown = groups.find(most->first);
    if (crown != group) groups.parent[group] = crown;
  }
}

// A low group of which nine tenths touch one crown that reaches down to it, within the width of a
// foot, is the hem of that crown.
void ObjectFinder::State::hem(Groups& groups) const {
  const auto steps = int(std::max(1.0, std::round(o.trunk_m / cell_m)));
  std::vector<uint32_t> crown(runs.size(), kNone), front, next;
  for (uint32_t i = 0; i < runs.size(); ++i) {
    if (!is_high(runs[i])) continue;
    crown[i] = groups.find(i);
    front.push_back(i);
  }
  for (int step = 0; step < steps; ++step, front.swap(next)) {
    next.clear();
    for (const uint32_t i : front) {
      for_each_neighbour(i, [&](uint32_t j) {
        const bool touches = runs[j].low <= runs[i].high + 1 && runs[i].low <= runs[j].high + 1;
        if (is_high(runs[j]) || crown[j] != kNone || !touches) return;
        crown[j] = crown[i];
        next.push_back(j);
      });
    }
  }
  std::map<uint32_t, std::map<uint32_t, uint32_t>> claims;  // columns by group and crown
  for (uint32_t i = 0; i < runs.size(); ++i) {
    const uint32_t group = groups.find(i);
    if (!is_high(runs[group])) ++claims[group][crown[i]];  // a foot is its tree's already
  }
  for (const auto& [group, by_crown] : claims) {
    uint32_t all = 0;
    for (const auto& [name, n] : by_crown) all += n;
    for (const auto& [name, n] : by_crown) {
      if (name != kNone && 10 * n >= 9 * all) groups.parent[group] = name;
    }
  }
}

void ObjectFinder::State::number(Groups& groups) {
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
    // Objects are as high as their top; a patch, as nine tenths of its columns.
    std::sort(s.tops.begin(), s.tops.end());
    FoundObject found;
    found.points = s.points;
    found.side_m = cell_m * (std::max(s.x1 - s.x0, s.y1 - s.y0) + 1);
    found.height_m = double(s.tops.back());
    if (is_high(runs[group]) && found.height_m >= o.sizes.tree_m) {
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

ObjectFinder::ObjectFinder(const ObjectOptions& o) : state_(std::make_unique<State>()) {
  require(o.cell_m >= 0 && o.gap_m >= 0 && o.spacing_a_m >= 0 && o.spacing_b >= 0 &&
              o.prominence_a_m >= 0 && o.prominence_b >= 0 && o.radius_a_m > 0 && o.radius_b >= 0 &&
              o.trunk_m >= 0,
          "objects: lengths must be positive");
  const SizeRules& s = o.sizes;
  require(s.tree_m > 0 && s.small_shrub_m <= s.medium_shrub_m &&
              s.medium_shrub_m <= s.large_shrub_m && s.medium_tree_m <= s.large_tree_m,
          "objects: the sizes' limits must rise from small to large");
  state_->o = o;
  state_->cell_m = state_->base_m();
}
ObjectFinder::~ObjectFinder() = default;

void ObjectFinder::add(std::span<const Vec3f> points) {
  const double side = state_->base_m();
  constexpr float kFar = 1e6f;
  for (const Vec3f& p : points) {
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > kFar) continue;
    state_->bins.push_back({int32_t(std::floor(double(p.y()) / side)),
                            int32_t(std::floor(double(p.x()) / side)),
                            int32_t(std::floor(double(p.z()) / kLayerM)), 1, p.z()});
  }
  if (state_->bins.size() > 2 * state_->merged + (1 << 22)) {
    merge(state_->bins);
    state_->merged = state_->bins.size();
  }
}

void ObjectFinder::find() {
  merge(state_->bins);
  state_->choose_cell();
  state_->make_runs();
  state_->smooth();
  Groups groups(state_->runs.size());
  state_->flood(groups);
  state_->adopt(groups, true);
  state_->join_low(groups);
  state_->adopt(groups, false);
  state_->hem(groups);
  state_->number(groups);
}

uint32_t ObjectFinder::object_of(const Vec3f& p) const {
  if (!p.allFinite()) return 0;
  const double side = state_->base_m();
  const auto at = [&](float v) {
    return floor_div(int32_t(std::floor(double(v) / side)), state_->cells);
  };
  const auto z = int32_t(std::floor(double(p.z()) / kLayerM));
  for (const Run& r : state_->column(at(p.x()), at(p.y()))) {
    if (z >= r.low && z <= r.high) return state_->object[size_t(&r - state_->runs.data())];
  }
  return 0;
}

const std::vector<FoundObject>& ObjectFinder::objects() const { return state_->objects; }
double ObjectFinder::cell_m() const { return state_->cell_m; }

}  // namespace underbrush::primitives
