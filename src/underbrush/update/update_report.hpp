/// \file
/// The report of an update.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/keyframes/keyframes.hpp"

namespace underbrush::update {

/// A square of 4 m where ellipsoids have gone.
struct ChangedPlace {
  Vec3 centre = Vec3::Zero();  ///< m, world: the mean of the ellipsoids.
  size_t gone = 0;             ///< Number of these ellipsoids.
};

/// Counts and warnings of an update.
struct UpdateReport {
  size_t beams = 0, hits = 0, misses = 0;  ///< Counts of the new scans.
  size_t mover_points = 0;                 ///< Points left out because of the flag `kMover`.
  size_t near_points = 0;                  ///< Points left out because nearer than `min_range_m`.
  size_t unexplained = 0;                  ///< New returns that no element explained before.
  size_t tiles = 0, touched_tiles = 0, fitted_tiles = 0;
  size_t earlier_beams = 0;  ///< Beams of the earlier logs that were traced once more.
  size_t kept = 0, added = 0, dropped = 0;  ///< Ellipsoids.
  size_t changed = 0;  ///< Ellipsoids whose earlier beams new beams contradict.
  size_t gone = 0;     ///< Ellipsoids of `changed` that were dropped as free space.
  keyframes::KeyframeChanges keyframes;
  std::vector<ChangedPlace> places;  ///< The squares where most have gone, at most ten.
  std::vector<std::string> warnings;
};

}  // namespace underbrush::update
