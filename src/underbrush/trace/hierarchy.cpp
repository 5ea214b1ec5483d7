#include "underbrush/trace/hierarchy.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "underbrush/core/parallel.hpp"

namespace underbrush::trace {
namespace {

struct Range {
  uint32_t begin = 0, end = 0;
  Box box, centres;  // of the references, and of twice their centres
  bool mixed = false;
  uint32_t size() const { return end - begin; }
};

/// Up to eight disjoint ranges.
struct Children {
  std::array<Range, kWidth> range;
  int count = 0;
};

class Splitter {
 public:
  Splitter(HugeVector<Ref>& refs, uint32_t leaf_size) : refs_(refs), leaf_size_(leaf_size) {}

  bool is_leaf(const Range& r) const { return r.size() <= leaf_size_ && !r.mixed; }

  void measure(Range& r) const {
    r.box = r.centres = Box();
    r.mixed = false;
    const uint32_t kind = refs_[r.begin].kind();
    for (uint32_t i = r.begin; i < r.end; ++i) {
      const Ref& ref = refs_[i];
      r.box.add(ref.lo, ref.hi);
      const Float4 centre = ref.centre2();
      r.centres.add(centre, centre);
      r.mixed |= ref.kind() != kind;
    }
  }

  /// Splits the child of the largest area until there are eight children.
  Children open(const Range& range) const {
    Children c;
    c.range[size_t(c.count++)] = range;
    while (c.count < kWidth) {
      int at = -1;
      for (int k = 0; k < c.count; ++k) {
        const Range& r = c.range[size_t(k)];
        if (!is_leaf(r) && (at < 0 || r.box.area() > c.range[size_t(at)].box.area())) at = k;
      }
      if (at < 0) break;
      split(c.range[size_t(at)], c.range[size_t(c.count++)]);
    }
    return c;
  }

 private:
  static constexpr int kBins = 16;

  struct Cut {
    Float4 base{}, scale{};
    int axis = -1, bin = 0;
    Box before, after;
  };

  /// Splits a range. `r` keeps the part before the split, and `after` gets the rest.
  void split(Range& r, Range& after) const {
    after.end = r.end;
    uint32_t middle = r.begin + r.size() / 2;
    if (r.mixed && r.size() <= 4 * leaf_size_) {  // by kind, while leaves can still be filled
      const auto begin = refs_.begin() + r.begin, end = refs_.begin() + r.end;
      const uint32_t kind = begin->kind();
      middle = uint32_t(std::partition(begin, end, [&](const Ref& x) { return x.kind() == kind; }) -
                        refs_.begin());
    } else if (const Cut cut = best_cut(r); cut.axis >= 0) {
      return divide(r, after, cut);
    }
    r.end = after.begin = middle;
    measure(r);
    measure(after);
  }

  /// Whether a range has references of several kinds.
  bool varies(const Range& r) const {
    return std::any_of(refs_.begin() + r.begin, refs_.begin() + r.end,
                       [&](const Ref& x) { return x.kind() != refs_[r.begin].kind(); });
  }

  /// Partitions a range and measures both sides in the same pass. The loop has no branches on the
  /// data.
  void divide(Range& r, Range& after, const Cut& cut) const {
    const uint32_t kind = refs_[r.begin].kind();
    const float base = cut.base[cut.axis], scale = cut.scale[cut.axis];
    const Box none;
    Box centres[2];
    uint32_t middle = r.begin, alike = 0, alike_before = 0;
    for (uint32_t i = r.begin; i < r.end; ++i) {
      const Ref ref = refs_[i];
      const Float4 centre = ref.centre2();
      const bool before = int32_t((ref.lo[cut.axis] + ref.hi[cut.axis] - base) * scale) < cut.bin;
      const Int4 is_before = Int4{} - int32_t(before);
      centres[0].add(is_before ? centre : none.lo, is_before ? centre : none.hi);
      centres[1].add(is_before ? none.lo : centre, is_before ? none.hi : centre);
      alike += ref.kind() == kind;
      alike_before += (ref.kind() == kind) & before;
      refs_[i] = refs_[middle];
      refs_[middle] = ref;
      middle += before;
    }
    r.end = after.begin = middle;
    r.box = cut.before;
    after.box = cut.after;
    r.centres = centres[0];
    after.centres = centres[1];
    // Without any of this kind, a side may have several others.
    r.mixed = alike_before == 0 ? varies(r) : alike_before != r.size();
    after.mixed = alike == alike_before ? varies(after) : alike - alike_before != after.size();
  }

  typedef int32_t Int4 __attribute__((vector_size(16)));
  static Int4 bin_of(const Ref& ref, const Cut& cut) {
    const Float4 at = (ref.centre2() - cut.base) * cut.scale;
    Int4 bin{int32_t(at[0]), int32_t(at[1]), int32_t(at[2]), 0};
    bin = bin < 0 ? Int4{} : bin;
    return bin > kBins - 1 ? Int4{} + (kBins - 1) : bin;
  }

  /// Finds the cut with the least surface-area cost, which counts leaves.
  Cut best_cut(const Range& r) const {
    Cut cut;
    cut.base = r.centres.lo;
    const Float4 extent = r.centres.hi - r.centres.lo;
    for (int d = 0; d < 3; ++d)
      cut.scale[d] = extent[d] > 1e-20f ? kBins * 0.99999f / extent[d] : 0;
    Box box[3][kBins];
    uint32_t count[3][kBins] = {};
    for (uint32_t i = r.begin; i < r.end; ++i) {
      const Ref& ref = refs_[i];
      const Int4 bin = bin_of(ref, cut);
      for (int d = 0; d < 3; ++d) {
        box[d][bin[d]].add(ref.lo, ref.hi);
        ++count[d][bin[d]];
      }
    }
    const auto leaves = [&](uint32_t n) { return float((n + leaf_size_ - 1) / leaf_size_); };
    float best = INFINITY;
    for (int d = 0; d < 3; ++d) {
      if (cut.scale[d] == 0) continue;
      uint32_t n[kBins], sum = 0;
      Box right[kBins + 1], left;
      for (int k = kBins - 1; k > 0; --k) {
        right[k] = right[k + 1];
        right[k].add(box[d][k]);
        n[k] = sum += count[d][k];
      }
      sum = 0;
      for (int k = 1; k < kBins; ++k) {
        left.add(box[d][k - 1]);
        sum += count[d][k - 1];
        if (sum == 0 || n[k] == 0) continue;
        const float cost = left.area() * leaves(sum) + right[k].area() * leaves(n[k]);
        if (cost < best) {
          best = cost;
          cut.axis = d;
          cut.bin = k;
          cut.before = left;
          cut.after = right[k];
        }
      }
    }
    return cut;
  }

  HugeVector<Ref>& refs_;
  uint32_t leaf_size_;
};

/// A subtree that one thread grows. Its references count from its own first node and leaf.
struct Part {
  std::vector<Node> nodes;
  std::vector<Leaf> leaves;
};

void set_child(Node& node, int k, const Range& r, uint32_t reference) {
  for (int d = 0; d < 3; ++d) {
    node.lo[d][k] = r.box.lo[d];
    node.hi[d][k] = r.box.hi[d];
  }
  node.child[k] = reference;
}

Node empty_node() {
  Node node;
  std::memset(&node, 0, sizeof(node));
  for (int k = 0; k < kWidth; ++k) {
    for (int d = 0; d < 3; ++d) {
      node.lo[d][k] = INFINITY;
      node.hi[d][k] = -INFINITY;
    }
    node.child[k] = kLeaf;
  }
  return node;
}

uint32_t grow(const Splitter& splitter, const Range& range, Part& part) {
  if (splitter.is_leaf(range)) {
    part.leaves.push_back({range.begin, range.size()});
    return kLeaf | uint32_t(part.leaves.size() - 1);
  }
  const Children c = splitter.open(range);
  const uint32_t me = uint32_t(part.nodes.size());
  part.nodes.push_back(empty_node());
  for (int k = 0; k < c.count; ++k) {
    const uint32_t reference = grow(splitter, c.range[size_t(k)], part);
    set_child(part.nodes[me], k, c.range[size_t(k)], reference);
  }
  return me;
}

/// A range that is still to be split or grown, and the place in the top of the tree that refers to
/// it.
struct Pending {
  Range range;
  uint32_t node;
  int child;
};

/// Joins the top of the tree and the subtrees below it in one array.
void join(std::vector<Node> top, const std::vector<Pending>& small,
          const std::vector<uint32_t>& root, std::vector<Part>& part, Hierarchy& tree) {
  std::vector<uint32_t> first_node(part.size()), first_leaf(part.size());
  uint32_t nodes = uint32_t(top.size()), leaves = 0;
  for (size_t i = 0; i < part.size(); ++i) {
    first_node[i] = nodes;
    first_leaf[i] = leaves;
    nodes += uint32_t(part[i].nodes.size());
    leaves += uint32_t(part[i].leaves.size());
  }
  const auto moved = [&](uint32_t reference, size_t i) {
    return reference + (reference & kLeaf ? first_leaf[i] : first_node[i]);
  };
  for (size_t i = 0; i < part.size(); ++i) {
    const uint32_t reference = moved(root[i], i);
    if (small[i].node == kEmpty) {
      tree.root = reference;
    } else {
      set_child(top[small[i].node], small[i].child, small[i].range, reference);
    }
  }
  if (!top.empty()) tree.root = 0;
  tree.nodes.resize(nodes);
  tree.leaves.resize(leaves);
  std::copy(top.begin(), top.end(), tree.nodes.begin());
  parallel_for(part.size(), 1, [&](size_t i, size_t) {
    std::copy(part[i].leaves.begin(), part[i].leaves.end(), tree.leaves.begin() + first_leaf[i]);
    for (size_t k = 0; k < part[i].nodes.size(); ++k) {
      Node& node = tree.nodes[first_node[i] + k] = part[i].nodes[k];
      for (int c = 0; c < kWidth; ++c) {
        if (node.lo[0][c] <= node.hi[0][c]) node.child[c] = moved(node.child[c], i);
      }
    }
    part[i] = {};
  });
}

}  // namespace

Hierarchy build_hierarchy(HugeVector<Ref>& refs, uint32_t leaf_size) {
  Hierarchy tree;
  if (refs.empty()) return tree;
  const Splitter splitter(refs, leaf_size);
  Range all;
  all.end = uint32_t(refs.size());
  splitter.measure(all);
  tree.box = all.box;
  // The top of the tree is built level by level. Ranges that are small enough wait, to be grown by
  // one thread each.
  constexpr uint32_t kGrain = 16384;
  std::vector<Node> top;
  std::vector<Pending> level{{all, kEmpty, 0}}, small;
  while (!level.empty()) {
    std::vector<Pending> large;
    for (Pending& p : level) (p.range.size() > kGrain ? large : small).push_back(p);
    std::vector<Children> opened(large.size());
    parallel_for(large.size(), 1,
                 [&](size_t i, size_t) { opened[i] = splitter.open(large[i].range); });
    level.clear();
    for (size_t i = 0; i < large.size(); ++i) {
      const uint32_t me = uint32_t(top.size());
      top.push_back(empty_node());
      if (large[i].node != kEmpty) {
        set_child(top[large[i].node], large[i].child, large[i].range, me);
      }
      for (int k = 0; k < opened[i].count; ++k) {
        level.push_back({opened[i].range[size_t(k)], me, k});
      }
    }
  }
  std::vector<Part> part(small.size());
  std::vector<uint32_t> root(small.size());
  parallel_for(small.size(), 1,
               [&](size_t i, size_t) { root[i] = grow(splitter, small[i].range, part[i]); });
  join(std::move(top), small, root, part, tree);
  return tree;
}

}  // namespace underbrush::trace
