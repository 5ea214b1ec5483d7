#include "underbrush/trace/scene_tree.hpp"

#include <cmath>

#include "underbrush/trace/element_math.hpp"

namespace underbrush::trace {
namespace {

constexpr float kOpenAbove = 12;  // m: subtrees larger than this are opened in unrotated instances

Box child_box(const Node& node, int k) {
  Box box;
  for (int d = 0; d < 3; ++d) {
    box.lo[d] = node.lo[d][k];
    box.hi[d] = node.hi[d][k];
  }
  return box;
}

bool is_used(const Node& node, int k) { return node.lo[0][k] <= node.hi[0][k]; }

/// Computes the world box, relative to `origin`, of a box of a model. It has a margin for the
/// rounding of the traversal in either frame.
Box placed_box(const elements::Instance& placed, const Mat3& rotation, const Vec3& origin,
               const Box& box) {
  Vec3 centre, half;
  for (int d = 0; d < 3; ++d) {
    centre[d] = 0.5 * (double(box.lo[d]) + box.hi[d]);
    half[d] = 0.5 * (double(box.hi[d]) - box.lo[d]);
  }
  const Vec3 c = placed.scale * (rotation * centre) + placed.world_from_model.translation - origin;
  const Vec3 h = placed.scale * (rotation.cwiseAbs() * half);
  Box out;
  for (int d = 0; d < 3; ++d) {
    const double margin = 1e-6 * (std::abs(c[d]) + h[d]) + 1e-5;
    out.lo[d] = float(c[d] - h[d] - margin);
    out.hi[d] = float(c[d] + h[d] + margin);
  }
  return out;
}

/// Computes the box of a whole instance from the boxes of its root's children, which is tighter
/// than from the root's box.
Box instance_box(const elements::Instance& placed, const Vec3& origin, const Bvh& bvh) {
  const Mat3 rotation = placed.world_from_model.rotation.toRotationMatrix();
  if (bvh.root & kLeaf) return placed_box(placed, rotation, origin, bvh.box);
  Box box;
  const Node& root = bvh.nodes[bvh.root];
  for (int k = 0; k < kWidth; ++k) {
    if (is_used(root, k)) box.add(placed_box(placed, rotation, origin, child_box(root, k)));
  }
  return box;
}

class Opener {
 public:
  Opener(const elements::Instance& placed, uint32_t instance, const Vec3& origin, const Bvh& bvh)
      : placed_(placed), instance_(instance), origin_(origin), bvh_(bvh) {}

  void open(uint32_t reference, const Box& box, std::vector<Subtree>& entries,
            HugeVector<Ref>& refs) const {
    const Float4 extent = box.hi - box.lo;
    if (!(reference & kLeaf) && placed_.scale * std::max(extent[0], extent[1]) > kOpenAbove) {
      const Node& node = bvh_.nodes[reference];
      for (int k = 0; k < kWidth; ++k) {
        if (is_used(node, k)) open(node.child[k], child_box(node, k), entries, refs);
      }
      return;
    }
    const Box world = placed_box(placed_, Mat3::Identity(), origin_, box);
    refs.emplace_back(world, uint32_t(entries.size()), 0);
    entries.push_back({instance_, reference});
  }

 private:
  const elements::Instance& placed_;
  uint32_t instance_;
  const Vec3& origin_;
  const Bvh& bvh_;
};

}  // namespace

SceneTree build_scene_tree(std::span<const elements::Instance> instances,
                           std::span<const Bvh> bvhs) {
  SceneTree tree;
  if (instances.empty()) return tree;
  tree.origin = instances.front().world_from_model.translation;
  if (instances.size() == 1) {  // a single instance needs no tree above it
    if (bvhs[instances[0].model].root == kEmpty) return tree;
    tree.entries = {{0, bvhs[instances[0].model].root}};
    tree.root = kLeaf;
    return tree;
  }
  HugeVector<Ref> refs;
  tree.entries.reserve(instances.size());
  refs.reserve(instances.size());
  for (uint32_t i = 0; i < instances.size(); ++i) {
    const elements::Instance& placed = instances[i];
    const Bvh& bvh = bvhs[placed.model];
    if (bvh.root == kEmpty) continue;
    if (is_translation(placed)) {
      Opener(placed, i, tree.origin, bvh).open(bvh.root, bvh.box, tree.entries, refs);
    } else {
      refs.emplace_back(instance_box(placed, tree.origin, bvh), uint32_t(tree.entries.size()), 0);
      tree.entries.push_back({i, bvh.root});
    }
  }
  Hierarchy hierarchy = build_hierarchy(refs, 1);
  const auto renamed = [&](uint32_t child) {
    return child != kEmpty && child & kLeaf
               ? kLeaf | refs[hierarchy.leaves[child & ~kLeaf].begin].id()
               : child;
  };
  tree.root = renamed(hierarchy.root);
  for (Node& node : hierarchy.nodes) {
    for (int k = 0; k < kWidth; ++k) {
      if (is_used(node, k)) node.child[k] = renamed(node.child[k]);
    }
  }
  tree.nodes = std::move(hierarchy.nodes);
  return tree;
}

}  // namespace underbrush::trace
