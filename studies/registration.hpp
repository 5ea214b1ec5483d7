/// \file
/// Two clouds brought into one frame: from conjugate points, or by iterated closest points.
#pragma once
#include <span>

#include "underbrush/core/pose.hpp"

namespace underbrush::studies {

/// x ↦ scale · R x + t.
struct Similarity {
  Pose pose;
  double scale = 1;
  Vec3 operator*(const Vec3& p) const { return pose.rotation * (scale * p) + pose.translation; }
};

/// The similarity, or with `rigid` the rigid transform, that brings `from` nearest to `to` in the
/// sum of squared distances, never a reflection [umeyama91]. Conjugate points, in the same order.
/// Throws `std::invalid_argument` for fewer than three, for lengths that differ, and for points on
/// a line.
Similarity align(std::span<const Vec3> from, std::span<const Vec3> to, bool rigid = true);

/// Options of `icp`.
struct IcpOptions {
  int most_iterations = 60;
  double most_distance_m = 0.5;  ///< Pairs further apart do not count.
  int neighbours = 20;           ///< For the normals of the cloud.
};

/// What iterated closest points came to.
struct IcpResult {
  Pose to_from_from;
  double rms_m = 0;    ///< Of the pairs' distances along the normals, at the end.
  double overlap = 0;  ///< Share of points with a pair.
  int iterations = 0;
  bool converged = false;  ///< The last step moved less than 1 µm and 1 µrad.
};

/// The rigid transform that lays `from` onto the surface through `to`, from `guess`: iterated
/// closest points [besl92], with distances measured along the normals of `to` [chen92]; a pair
/// counts where it is no further than thrice the median (1 mm at least) and `most_distance_m`.
/// Throws `std::invalid_argument` for clouds of fewer than ten points or without common points.
IcpResult icp(std::span<const Vec3> from, std::span<const Vec3> to, const Pose& guess = {},
              const IcpOptions& options = {});

}  // namespace underbrush::studies
