/// \file
/// The nodes of an octree while it is built.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "underbrush/core/file.hpp"
#include "underbrush/serve/octree_point.hpp"

namespace underbrush::serve {

/// A node: the place of its points in the file, and its children as indices into the list of nodes,
/// 0 where there is none (the root is no node's child).
struct TreeNode {
  uint64_t at = 0;
  uint32_t points = 0;
  uint8_t level = 0;
  std::array<uint32_t, 8> child{};
};

/// A part of a tree whose root is not the tree's: nodes, the first of them its root, and the bytes
/// of their points, at `TreeNode::at` within `bytes`.
struct SubTree {
  std::vector<TreeNode> nodes;
  std::string bytes;
};

/// Appends the columns of a node's points to `bytes`, in the order of their rank, and pads them to
/// a multiple of 8 bytes. Sorts `points`.
void append_points(std::vector<OctreePoint>& points, const OctreeRoot& root, uint32_t level,
                   std::string& bytes);

/// Builds the part of a tree below a node of `level` from all points that lie in it and that no
/// node above has taken. Throws `DataError` where too many points are at one place.
SubTree sub_tree(const std::vector<OctreePoint>& points, const OctreeRoot& root, uint32_t level);

/// Appends the nodes below `nodes[0]` to the file: header, table of nodes level by level, runs and
/// description. `file` holds a header's worth of bytes and the points.
void write_tables(const std::vector<TreeNode>& nodes, const std::vector<OctreeRun>& runs,
                  const std::string& json, uint64_t points, uint64_t end, OutputFile& file);

}  // namespace underbrush::serve
