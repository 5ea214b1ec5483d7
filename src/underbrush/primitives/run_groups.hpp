/// \file
/// Grouping of runs into trees and lower objects.
#pragma once
#include <cstdint>
#include <numeric>
#include <vector>

#include "underbrush/primitives/object_options.hpp"
#include "underbrush/primitives/run_graph.hpp"

namespace underbrush::primitives {

/// Disjoint sets (union-find). The root of a set is the member that came first.
struct Groups {
  std::vector<uint32_t> parent;
  explicit Groups(size_t n) : parent(n) { std::iota(parent.begin(), parent.end(), 0u); }
  uint32_t find(uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  }
};

/// Whether a run is high enough to be part of a crown.
inline bool is_high(const Run& run, const SizeRules& sizes) {
  return double(run.top_m) >= 0.7 * sizes.tree_m;
}

/// Joins the runs of a graph (after `build()`) to objects, as `ObjectFinder` describes. The root of
/// a tree is its peak.
Groups group_runs(const RunGraph& graph, const ObjectOptions& options);

}  // namespace underbrush::primitives
