/// \file
/// The upper part of an octree that is built out of core: it takes the points of its own nodes as
/// they come and hands the others on to chunks, each of which fits into memory.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "underbrush/serve/octree_survey.hpp"
#include "underbrush/serve/octree_tree.hpp"

namespace underbrush::serve {

/// A part of the tree below the upper nodes.
struct Chunk {
  uint32_t parent = 0, octant = 0;  ///< Upper node that it hangs on.
  uint32_t level = 0;
  uint64_t capacity = 0;   ///< Points that lie in it; upper nodes may take some.
  bool too_large = false;  ///< Whether it has to be divided once more.
};

/// Upper nodes and chunks. A point is put in at the root and goes down until it finds a free cell;
/// where another point with a higher rank is in the way, the two change places and that one goes
/// on. The nodes' points in the end do not depend on the order.
class Division {
 public:
  /// Divides the cube of a node of `level` so that chunks have at most `chunk_points` points.
  /// `cells` are the points' counts, of side 2^cell_bits units.
  Division(const OctreeRoot& root, uint32_t level, std::vector<CellCounts::Cell> cells,
           uint32_t cell_bits, size_t chunk_points);

  static constexpr uint32_t kTaken = UINT32_MAX;
  /// Puts a point in. Returns `kTaken`, or the chunk to which `p`, which may be another point now,
  /// belongs.
  uint32_t put(OctreePoint& p);

  const std::vector<Chunk>& chunks() const { return chunks_; }
  size_t upper_nodes() const { return nodes_.size(); }
  /// Level of an upper node, its children that are upper nodes too (0 = none), and its points.
  uint32_t level(size_t node) const { return nodes_[node].level; }
  const std::array<uint32_t, 8>& children(size_t node) const { return nodes_[node].upper; }
  std::vector<OctreePoint>& points(size_t node) { return nodes_[node].points; }

 private:
  static constexpr uint32_t kNone = UINT32_MAX;
  static constexpr uint32_t kPageCells = 4096;
  using Page = std::array<uint32_t, kPageCells>;
  struct Node {
    uint32_t level = 0;
    std::array<uint32_t, 8> upper{};  ///< 0 = none
    std::array<uint32_t, 8> chunk{};
    std::vector<OctreePoint> points;
    std::array<std::unique_ptr<Page>, 64> pages;  ///< Index of the point in each cell.
  };
  struct Range {
    size_t begin, end;
  };

  uint32_t split(Range cells, uint32_t level);

  OctreeRoot root_;
  uint32_t cell_bits_;
  size_t chunk_points_;
  std::vector<CellCounts::Cell> cells_;
  std::vector<Node> nodes_;
  std::vector<Chunk> chunks_;
};

}  // namespace underbrush::serve
