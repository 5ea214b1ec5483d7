/// \file
/// The hierarchy over the instances of a scene.
#pragma once
#include <span>
#include <vector>

#include "underbrush/elements/scene.hpp"
#include "underbrush/trace/bvh.hpp"

namespace underbrush::trace {

/// A subtree of an instance's model.
struct Subtree {
  uint32_t instance;
  uint32_t node;  ///< A reference within the model's Bvh.
};

/// Boxes relative to `origin`; leaves are kLeaf | index of an entry. Large instances
/// that stand unrotated, such as a ground, are entered by several subtrees, so that their parts and
/// the instances upon them are visited from near to far.
struct SceneTree {
  HugeVector<Node> nodes;
  std::vector<Subtree> entries;
  uint32_t root = kEmpty;
  Vec3 origin = Vec3::Zero();

  size_t bytes() const { return nodes.size() * sizeof(Node) + entries.size() * sizeof(Subtree); }
};

/// `bvhs[i]` is that of the scene's model i.
SceneTree build_scene_tree(std::span<const elements::Instance> instances,
                           std::span<const Bvh> bvhs);

}  // namespace underbrush::trace
