/// \file
/// Skeletons of plants: the axes of branches that grow into free space, and the thickness that
/// follows from the tips that they carry.
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::test_site {

/// Angle (rad) by which each leaf or shoot is turned from the one before.
inline constexpr double kGoldenAngle = 2.399963229728653;

/// Nodes joined to their parents. A parent comes before its children; a root has parent −1.
struct Skeleton {
  std::vector<Vec3> position;  ///< m, in the plant's frame.
  std::vector<int32_t> parent;

  size_t size() const { return position.size(); }
  /// Appends a node and returns its index.
  int32_t add(const Vec3& at, int32_t parent_node) {
    position.push_back(at);
    parent.push_back(parent_node);
    return int32_t(size() - 1);
  }
  /// Returns the vector from the parent to node `i` (zero for a root).
  Vec3 segment(size_t i) const {
    return parent[i] < 0 ? Vec3(Vec3::Zero()) : Vec3(position[i] - position[size_t(parent[i])]);
  }
};

/// Appends a curved limb of about `length_m` that begins at node `from`, in steps of `step_m`. It
/// starts along the unit vector `direction` and bends by `rise` (m of height per m²; negative
/// values droop). Returns the index of its tip.
int32_t add_limb(Skeleton& skeleton, int32_t from, const Vec3& direction, double length_m,
                 double step_m, double rise);

/// Options of `grow_into`.
struct GrowthOptions {
  double step_m = 0.15;      ///< m; length of a segment.
  double reached_m = 0.25;   ///< m; a marker this near to a node is reached.
  double persistence = 0.5;  ///< Weight of the previous direction against the direction to the
                             ///< markers.
};

/// Grows branches by space colonisation ([runions07]): each marker of free space attracts the node
/// nearest to it, attracted nodes grow a step in the mean direction of their markers, and markers
/// that are reached vanish.
void grow_into(Skeleton& skeleton, std::vector<Vec3> markers, const GrowthOptions& options);

/// Appends a straight side shoot of `length_m` ± 30 % to each node that is marked in `twig`; each
/// shoot is turned by the golden angle from the one before.
void add_side_shoots(Skeleton& skeleton, const std::vector<bool>& twig, double length_m,
                     Stream& random);

/// Returns the number of branch tips that each node carries (a tip carries itself).
std::vector<uint32_t> carried_tips(const Skeleton& skeleton);

/// Marks the outer twigs: the nodes that have a parent and carry at most `most` tips.
std::vector<bool> twigs(const Skeleton& skeleton, uint32_t most);

/// Returns the radii (m) of the nodes by the pipe model ([shinozaki64]): rᵉ adds up over branches,
/// with e such that a tip has the radius `tip_m` and the root that carries most has `base_m`.
std::vector<double> pipe_radii(const std::vector<uint32_t>& tips, double base_m, double tip_m);

}  // namespace underbrush::test_site
