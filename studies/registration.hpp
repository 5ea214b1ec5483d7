/// \file
/// Registration of two clouds, from conjugate points or by iterated closest points.
#pragma once
#include <span>

#include "underbrush/core/pose.hpp"

namespace underbrush::studies {

/// A similarity transform x ↦ scale · R x + t.
struct Similarity {
  Pose pose;
  double scale = 1;
  Vec3 operator*(const Vec3& p) const { return pose.rotation * (scale * p) + pose.translation; }
};

/// Returns the similarity, or with `rigid` the rigid transform, that minimises the sum of squared
/// distances between the transformed `from` and `to`; it is never a reflection [umeyama91]. The
/// points must be conjugate, in the same order. Throws `std::invalid_argument` for fewer than
/// three, for lengths that differ, and for points on a line.
Similarity align(std::span<const Vec3> from, std::span<const Vec3> to, bool rigid = true);

/// Options of `icp`.
struct IcpOptions {
  int most_iterations = 60;
  double most_distance_m = 0.5;  ///< Pairs further apart do not count.
  int neighbours = 20;           ///< Neighbours for the normals of the cloud.
};

/// The result of `icp`.
struct IcpResult {
  Pose to_from_from;
  double rms_m = 0;  ///< m; root mean square of the pairs' distances along the normals, at the end.
  double overlap = 0;  ///< Share of points with a pair.
  int iterations = 0;
  bool converged = false;  ///< Whether the last step moved less than 1 µm and 1 µrad.
};

/// Returns the rigid transform that lays `from` onto the surface through `to`, starting from
/// `guess`. It iterates closest points [besl92], with distances measured along the normals of `to`
/// [chen92]. A pair counts where its distance is at most thrice the median (1 mm at least) and at
/// most `most_distance_m`. Throws `std::invalid_argument` for clouds of fewer than ten points or
/// without common points.
IcpResult icp(std::span<const Vec3> from, std::span<const Vec3> to, const Pose& guess = {},
              const IcpOptions& options = {});

}  // namespace underbrush::studies
