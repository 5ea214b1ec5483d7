/// \file
/// The axes of a plant's branches: grown towards free space, thickened by what they carry.
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::test_site {

/// Angle (rad) by which leaves and shoots turn from one to the next.
inline constexpr double kGoldenAngle = 2.399963229728653;

/// Nodes joined to their parents; a parent stands before its children, a root has parent −1.
struct Skeleton {
  std::vector<Vec3> position;  ///< m, plant frame.
  std::vector<int32_t> parent;

  size_t size() const { return position.size(); }
  /// Appends a node; its index.
  int32_t add(const Vec3& at, int32_t parent_node) {
    position.push_back(at);
    parent.push_back(parent_node);
    return int32_t(size() - 1);
  }
  /// Vector from the parent to node `i` (zero for a root).
  Vec3 segment(size_t i) const {
    return parent[i] < 0 ? Vec3(Vec3::Zero()) : Vec3(position[i] - position[size_t(parent[i])]);
  }
};

/// Appends a curved limb of about `length_m` from `from`, in steps of `step_m`: it starts along the
/// unit vector `direction` and bends by `rise` (m of height per m², negative droops). Index of its
/// tip.
int32_t add_limb(Skeleton& skeleton, int32_t from, const Vec3& direction, double length_m,
                 double step_m, double rise);

/// How branches grow into free space.
struct GrowthOptions {
  double step_m = 0.15;      ///< Length of a segment.
  double reached_m = 0.25;   ///< A space marker this near to a node is taken.
  double persistence = 0.5;  ///< Weight of going straight on against turning to the markers.
};

/// Space colonisation ([runions07]): each marker of free space draws the node nearest to it; nodes
/// that are drawn grow a step towards the mean direction; markers reached vanish.
void grow_into(Skeleton& skeleton, std::vector<Vec3> markers, const GrowthOptions& options);

/// Appends a straight side shoot of ±30 % `length_m` to each node that is `twig`, turned by the
/// golden angle from one to the next.
void add_side_shoots(Skeleton& skeleton, const std::vector<bool>& twig, double length_m,
                     Stream& random);

/// Number of branch tips that each node carries (a tip carries itself).
std::vector<uint32_t> carried_tips(const Skeleton& skeleton);

/// Which nodes have a parent and carry at most `most` tips: the outer twigs.
std::vector<bool> twigs(const Skeleton& skeleton, uint32_t most);

/// Radii (m) by the pipe model ([shinozaki64]): rᵉ adds up over branches, with e such that a tip
/// has `tip_m` and the root that carries most has `base_m`.
std::vector<double> pipe_radii(const std::vector<uint32_t>& tips, double base_m, double tip_m);

}  // namespace underbrush::test_site
