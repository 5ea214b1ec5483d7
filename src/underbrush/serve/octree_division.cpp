#include "underbrush/serve/octree_division.hpp"

#include <algorithm>

namespace underbrush::serve {

Division::Division(const OctreeRoot& root, uint32_t level, std::vector<CellCounts::Cell> cells,
                   uint32_t cell_bits, size_t chunk_points)
    : root_(root), cell_bits_(cell_bits), chunk_points_(chunk_points), cells_(std::move(cells)) {
  uint64_t points = 0;
  for (const CellCounts::Cell& c : cells_) points += c.points;
  if (points <= chunk_points_) {
    chunks_.push_back({0, 0, level, points, false});
  } else {
    split({0, cells_.size()}, level);
  }
  cells_.clear();
  cells_.shrink_to_fit();
}

uint32_t Division::split(Range cells, uint32_t level) {
  const uint32_t node = uint32_t(nodes_.size());
  nodes_.emplace_back();
  nodes_[node].level = level;
  nodes_[node].chunk.fill(kNone);
  const uint32_t shift = root_.bits - level - 1 - cell_bits_;
  const auto octant = [&](const CellCounts::Cell& c) {
    const auto part = [&](size_t k) { return uint32_t(c.at[k] >> shift) & 1u; };
    return part(0) | part(1) << 1 | part(2) << 2;
  };
  const auto first = cells_.begin() + ptrdiff_t(cells.begin);
  std::stable_sort(first, cells_.begin() + ptrdiff_t(cells.end),
                   [&](const auto& a, const auto& b) { return octant(a) < octant(b); });
  size_t at = cells.begin;
  for (uint32_t k = 0; k < 8; ++k) {
    const size_t begin = at;
    uint64_t points = 0;
    for (; at < cells.end && octant(cells_[at]) == k; ++at) points += cells_[at].points;
    if (points == 0) continue;
    const bool one_cell = shift == 0;
    if (points <= chunk_points_ || one_cell) {
      nodes_[node].chunk[k] = uint32_t(chunks_.size());
      chunks_.push_back({node, k, level + 1, points, points > chunk_points_});
    } else {
      const uint32_t child = split({begin, at}, level + 1);
      nodes_[node].upper[k] = child;
    }
  }
  return node;
}

uint32_t Division::put(OctreePoint& p) {
  if (nodes_.empty()) return 0;
  uint32_t k = 0;
  for (;;) {
    Node& n = nodes_[k];
    const uint32_t cell = root_.cell(p, n.level);
    std::unique_ptr<Page>& page = n.pages[cell / kPageCells];
    if (!page) {
      page = std::make_unique<Page>();
      page->fill(kNone);
    }
    uint32_t& there = (*page)[cell % kPageCells];
    if (there == kNone) {
      there = uint32_t(n.points.size());
      n.points.push_back(p);
      return kTaken;
    }
    OctreePoint& other = n.points[there];
    if (rank_of(p.row) < rank_of(other.row)) std::swap(p, other);
    const uint32_t octant = root_.octant(p, n.level);
    if (n.upper[octant] == 0) return n.chunk[octant];
    k = n.upper[octant];
  }
}

}  // namespace underbrush::serve
