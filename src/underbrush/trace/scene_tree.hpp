/// \file
/// This file has the hierarchy over the instances of a scene.
#pragma once
#include <span>
#include <vector>

#include "underbrush/elements/scene.hpp"
#include "underbrush/trace/bvh.hpp"

namespace underbrush::trace {

/// A subtree of an instance's model.
struct Subtree {
  uint32_t instance;
  uint32_t node;  ///< Reference within the model's Bvh.
};

/// The hierarchy over the instances of a scene. Boxes are relative to `origin` (m), and leaves are
/// kLeaf | index of an entry. A large unrotated instance, such as the ground, has
/// several entries, one for each of its subtrees, so that its parts and the instances on it are
/// visited from near to far.
struct SceneTree {
  HugeVector<Node> nodes;
  std::vector<Subtree> entries;
  uint32_t root = kEmpty;
  Vec3 origin = Vec3::Zero();

  size_t bytes() const { return nodes.size() * sizeof(Node) + entries.size() * sizeof(Subtree); }
};

/// Builds the hierarchy. `bvhs[i]` is the hierarchy of the scene's model i.
SceneTree build_scene_tree(std::span<const elements::Instance> instances,
                           std::span<const Bvh> bvhs);

}  // namespace underbrush::trace
