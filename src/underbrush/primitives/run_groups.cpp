#include "underbrush/primitives/run_groups.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

namespace underbrush::primitives {
namespace {

class Grouping {
 public:
  Grouping(const RunGraph& graph, const ObjectOptions& o)
      : graph_(graph), runs_(graph.runs()), o_(o), groups_(runs_.size()), smooth_m_(runs_.size()) {}

  Groups run() && {
    smooth();
    flood();
    adopt(true);
    join_low();
    adopt(false);
    hem();
    return std::move(groups_);
  }

 private:
  bool is_high(const Run& run) const { return primitives::is_high(run, o_.sizes); }
  void smooth();
  void flood();
  void join_low();
  void adopt(bool trees);
  void hem();

  const RunGraph& graph_;
  const std::vector<Run>& runs_;
  const ObjectOptions& o_;
  Groups groups_;
  std::vector<float> smooth_m_;  // m; mean of the tops around each run.
};

// Averages each top with the higher ones around it, so that no leaf is a peak and no hole a pit.
void Grouping::smooth() {
  constexpr double kHigher = 0.4;
  std::vector<float> tops;
  for (uint32_t i = 0; i < runs_.size(); ++i) {
    if (!is_high(runs_[i])) continue;
    tops.assign(1, runs_[i].top_m);
    graph_.for_each_neighbour(i, [&](uint32_t j) {
      if (is_high(runs_[j])) tops.push_back(runs_[j].top_m);
    });
    std::sort(tops.begin(), tops.end(), std::greater<>());
    const auto n = std::max<size_t>(1, size_t(kHigher * double(tops.size())));
    float sum = runs_[i].top_m;
    for (size_t k = 0; k < n; ++k) sum += tops[k];
    smooth_m_[i] = sum / float(n + 1);
  }
}

// Floods the crowns from the highest run down. The root of a crown's group is its peak.
void Grouping::flood() {
  std::vector<uint32_t> order;
  for (uint32_t i = 0; i < runs_.size(); ++i) {
    if (is_high(runs_[i])) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return smooth_m_[a] > smooth_m_[b]; });
  std::vector<uint8_t> wet(runs_.size(), 0);
  std::vector<uint32_t> crowns;
  const double shallow = graph_.is_sparse() ? 0.5 : 1;  // Wide columns smooth dips away.
  for (const uint32_t i : order) {
    crowns.clear();
    uint32_t best = RunGraph::kNone;
    float highest = -1;
    graph_.for_each_neighbour(i, [&](uint32_t j) {
      if (!wet[j]) return;
      const uint32_t peak = groups_.find(j);
      if (std::find(crowns.begin(), crowns.end(), peak) == crowns.end()) crowns.push_back(peak);
      const double reach = o_.radius_a_m + o_.radius_b * double(runs_[peak].top_m);
      if (smooth_m_[j] > highest && graph_.distance_m(runs_[peak], runs_[i]) <= reach) {
        highest = smooth_m_[j];
        best = peak;
      }
    });
    wet[i] = 1;
    if (best == RunGraph::kNone) continue;
    groups_.parent[i] = best;
    for (uint32_t other : crowns) {
      best = groups_.find(i);
      other = groups_.find(other);
      if (other == best) continue;
      const bool lower = smooth_m_[other] < smooth_m_[best] ||
                         (smooth_m_[other] == smooth_m_[best] && other > best);
      const uint32_t low = lower ? other : best, high = lower ? best : other;
      const double h = double(runs_[low].top_m), apart = graph_.distance_m(runs_[low], runs_[high]);
      const double dip = double(smooth_m_[low] - smooth_m_[i]);
      if (apart < o_.spacing_a_m + o_.spacing_b * h ||
          (dip < shallow * (o_.prominence_a_m + o_.prominence_b * h) &&
           apart < o_.radius_a_m + o_.radius_b * h)) {
        groups_.parent[low] = high;
      }
    }
  }
}

// Joins the runs that are lower than a tree to connected groups.
void Grouping::join_low() {
  for (uint32_t i = 0; i < runs_.size(); ++i) {
    if (is_high(runs_[i])) continue;
    graph_.for_each_neighbour(i, [&](uint32_t j) {
      if (is_high(runs_[j])) return;
      const uint32_t a = groups_.find(i), b = groups_.find(j);
      if (a != b) groups_.parent[std::max(a, b)] = std::min(a, b);
    });
  }
}

// Lets narrow groups (trees if `trees`, else others) join a crown that most of their columns lie
// below, above or beside: feet, trunks that end in the scan's shadow, and tips that stand apart.
void Grouping::adopt(bool trees) {
  struct Extent {
    int32_t x0 = INT32_MAX, x1 = INT32_MIN, y0 = INT32_MAX, y1 = INT32_MIN;
    std::map<uint32_t, uint32_t> crowns;  // Number of columns that saw each crown.
    uint32_t columns = 0, covered = 0;
  };
  const int32_t reach = trees ? 0 : 1;  // A tree needs the crown in its own columns.
  std::map<uint32_t, Extent> extents;
  for (uint32_t i = 0; i < runs_.size(); ++i) {
    const Run& r = runs_[i];
    if (is_high(runs_[i]) != trees) continue;
    const uint32_t group = groups_.find(i);
    Extent& e = extents[group];
    e.x0 = std::min(e.x0, r.x), e.x1 = std::max(e.x1, r.x);
    e.y0 = std::min(e.y0, r.y), e.y1 = std::max(e.y1, r.y);
    ++e.columns;
    bool covered = false;
    for (int32_t dy = -reach; dy <= reach; ++dy) {
      for (int32_t dx = -reach; dx <= reach; ++dx) {
        for (const Run& other : graph_.column(r.x + dx, r.y + dy)) {
          const auto j = graph_.index_of(other);
          if (!is_high(runs_[j]) || groups_.find(j) == group) continue;
          ++e.crowns[groups_.find(j)];
          covered = true;
        }
      }
    }
    e.covered += covered;
  }
  const double narrow = std::max(o_.trunk_m, 2 * graph_.cell_m());
  for (const auto& [group, e] : extents) {
    const double side = graph_.cell_m() * (std::max(e.x1 - e.x0, e.y1 - e.y0) + 1);
    if (e.crowns.empty() || side > narrow + 1e-9 || 2 * e.covered < e.columns) continue;
    const auto most =
        std::max_element(e.crowns.begin(), e.crowns.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    const uint32_t crown = groups_.find(most->first);
    if (crown != group) groups_.parent[group] = crown;
  }
}

// Joins a low group to a crown as its hem if nine tenths of the group touch the crown, which
// reaches down to it, within the width of a foot.
void Grouping::hem() {
  const auto steps = int(std::max(1.0, std::round(o_.trunk_m / graph_.cell_m())));
  std::vector<uint32_t> crown(runs_.size(), RunGraph::kNone), front, next;
  for (uint32_t i = 0; i < runs_.size(); ++i) {
    if (!is_high(runs_[i])) continue;
    crown[i] = groups_.find(i);
    front.push_back(i);
  }
  for (int step = 0; step < steps; ++step, front.swap(next)) {
    next.clear();
    for (const uint32_t i : front) {
      graph_.for_each_neighbour(i, [&](uint32_t j) {
        const bool touches = runs_[j].low <= runs_[i].high + 1 && runs_[i].low <= runs_[j].high + 1;
        if (is_high(runs_[j]) || crown[j] != RunGraph::kNone || !touches) return;
        crown[j] = crown[i];
        next.push_back(j);
      });
    }
  }
  std::map<uint32_t, std::map<uint32_t, uint32_t>> claims;  // Columns by group and crown.
  for (uint32_t i = 0; i < runs_.size(); ++i) {
    const uint32_t group = groups_.find(i);
    if (!is_high(runs_[group])) ++claims[group][crown[i]];  // A foot belongs to its tree already.
  }
  for (const auto& [group, by_crown] : claims) {
    uint32_t all = 0;
    for (const auto& [name, n] : by_crown) all += n;
    for (const auto& [name, n] : by_crown) {
      if (name != RunGraph::kNone && 10 * n >= 9 * all) groups_.parent[group] = name;
    }
  }
}

}  // namespace

Groups group_runs(const RunGraph& graph, const ObjectOptions& options) {
  return Grouping(graph, options).run();
}

}  // namespace underbrush::primitives
