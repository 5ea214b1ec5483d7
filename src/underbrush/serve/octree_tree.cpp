#include "underbrush/serve/octree_tree.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>

#include "underbrush/core/check.hpp"

namespace underbrush::serve {
namespace {

constexpr uint32_t kFree = std::numeric_limits<uint32_t>::max();

// Builds a part of the tree from the top to the bottom. The points keep their places; nodes divide
// a list of their indices.
class SubTreeBuilder {
 public:
  SubTreeBuilder(const std::vector<OctreePoint>& points, const OctreeRoot& root)
      : points_(points),
        root_(root),
        order_(points.size()),
        other_(points.size()),
        winner_(size_t(kNodeCells) * kNodeCells * kNodeCells, kFree) {
    std::iota(order_.begin(), order_.end(), 0u);
  }

  uint32_t build(size_t begin, size_t end, uint32_t level) {
    const uint32_t node = uint32_t(out_.nodes.size());
    out_.nodes.emplace_back();
    out_.nodes[node].level = uint8_t(level);
    if (end - begin <= kLeafPoints || level >= root_.deepest()) {
      require_data(end - begin <= (size_t(1) << 24), "more than 16 777 216 points at one place");
      take(node, begin, end);
      return node;
    }
    std::array<size_t, 9> first{};
    const size_t taken = divide(begin, end, level, first);
    take(node, begin, begin + taken);
    for (uint32_t k = 0; k < 8; ++k) {
      if (first[k] == first[k + 1]) continue;
      const uint32_t child = build(first[k], first[k + 1], level + 1);
      out_.nodes[node].child[k] = child;
    }
    return node;
  }
  SubTree result() { return std::move(out_); }

 private:
  // Orders [begin, end) into the points that this node takes and those of each octant, which begin
  // at `first`. Returns how many it takes.
  size_t divide(size_t begin, size_t end, uint32_t level, std::array<size_t, 9>& first) {
    for (size_t i = begin; i < end; ++i) {
      uint32_t& best = winner_[root_.cell(points_[order_[i]], level)];
      if (best == kFree || rank_of(points_[order_[i]].row) < rank_of(points_[best].row)) {
        best = order_[i];
      }
    }
    std::array<size_t, 9> count{};  // octants, then those taken
    const auto part = [&](uint32_t i) {
      const OctreePoint& p = points_[i];
      return winner_[root_.cell(p, level)] == i ? 8u : root_.octant(p, level);
    };
    for (size_t i = begin; i < end; ++i) ++count[part(order_[i])];
    first[0] = begin + count[8];
    for (size_t k = 0; k < 8; ++k) first[k + 1] = first[k] + count[k];
    std::array<size_t, 9> next = first;
    next[8] = begin;
    for (size_t i = begin; i < end; ++i) other_[next[part(order_[i])]++] = order_[i];
    for (size_t i = begin; i < end; ++i) {
      order_[i] = other_[i];
      winner_[root_.cell(points_[order_[i]], level)] = kFree;
    }
    return count[8];
  }

  void take(uint32_t node, size_t begin, size_t end) {
    taken_.clear();
    for (size_t i = begin; i < end; ++i) taken_.push_back(points_[order_[i]]);
    out_.nodes[node].at = out_.bytes.size();
    out_.nodes[node].points = uint32_t(end - begin);
    append_points(taken_, root_, out_.nodes[node].level, out_.bytes);
  }

  const std::vector<OctreePoint>& points_;
  const OctreeRoot& root_;
  std::vector<uint32_t> order_, other_, winner_;
  std::vector<OctreePoint> taken_;
  SubTree out_;
};

}  // namespace

void append_points(std::vector<OctreePoint>& points, const OctreeRoot& root, uint32_t level,
                   std::string& bytes) {
  std::sort(points.begin(), points.end(), [](const OctreePoint& a, const OctreePoint& b) {
    return rank_of(a.row) < rank_of(b.row);
  });
  const auto column = [&](auto value_of) {
    using Value = decltype(value_of(points[0]));
    const size_t start = bytes.size();
    bytes.resize(start + points.size() * sizeof(Value));
    char* to = bytes.data() + start;
    for (const OctreePoint& p : points) {
      const Value v = value_of(p);
      std::memcpy(to, &v, sizeof(v));
      to += sizeof(v);
    }
  };
  const int64_t within = (int64_t(1) << (root.bits - level)) - 1;
  column([&](const OctreePoint& p) {
    std::array<float, 3> at{};
    for (size_t c = 0; c < 3; ++c) at[c] = float(double(p.at[c] & within) * kUnitM);
    return at;
  });
  column([](const OctreePoint& p) { return p.intensity; });
  column([](const OctreePoint& p) { return p.time_s; });
  column([](const OctreePoint& p) { return p.row; });
  column([](const OctreePoint& p) { return p.ring; });
  column([](const OctreePoint& p) { return p.label; });
  column([](const OctreePoint& p) { return p.echo; });
  bytes.resize((bytes.size() + 7) / 8 * 8);
}

SubTree sub_tree(const std::vector<OctreePoint>& points, const OctreeRoot& root, uint32_t level) {
  SubTreeBuilder builder(points, root);
  builder.build(0, points.size(), level);
  return builder.result();
}

void write_tables(const std::vector<TreeNode>& nodes, const std::vector<OctreeRun>& runs,
                  const std::string& json, uint64_t points, uint64_t end, OutputFile& file) {
  std::vector<uint32_t> order{0};  // level by level
  std::vector<OctreeNode> table;
  for (size_t k = 0; k < order.size(); ++k) {
    const TreeNode& n = nodes[order[k]];
    OctreeNode row{n.at, n.points, uint32_t(order.size()), 0, n.level, {}};
    for (uint32_t c = 0; c < 8; ++c) {
      if (n.child[c] == 0) continue;
      row.children = uint8_t(row.children | 1u << c);
      order.push_back(n.child[c]);
    }
    if (row.children == 0) row.first_child = 0;
    table.push_back(row);
  }
  OctreeHeader header;
  header.nodes = uint32_t(table.size());
  header.points = points;
  header.nodes_at = end;
  header.runs_at = header.nodes_at + table.size() * sizeof(OctreeNode);
  header.runs = runs.size();
  header.json_at = header.runs_at + runs.size() * sizeof(OctreeRun);
  header.json_bytes = json.size();
  file.overwrite(header.nodes_at, table.data(), table.size() * sizeof(OctreeNode));
  file.overwrite(header.runs_at, runs.data(), runs.size() * sizeof(OctreeRun));
  file.overwrite(header.json_at, json.data(), json.size());
  file.overwrite(0, &header, sizeof(header));
}

}  // namespace underbrush::serve
