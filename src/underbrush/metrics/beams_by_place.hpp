/// \file
/// The beams of a log by where they end, for those that are seen from a place in some directions.
#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::metrics {

/// Beams as they are seen from one place.
struct SeenBeams {
  std::vector<Vec3f> direction;  ///< Unit vectors, world.
  std::vector<uint32_t> row;     ///< Rows of the log.
};

/// The direction in which the end of beam `i` is seen from a place (m, world). A beam that missed
/// has no end and keeps its own direction.
Vec3 direction_from(const Vec3& place, const BeamLog& log, uint32_t i);

/// Some rows of a log in cells of 2 m by where their beams end, so that what is seen from a place
/// in some directions is found without a look at every beam.
class BeamsByPlace {
 public:
  /// `log` must outlive it.
  BeamsByPlace(const BeamLog& log, std::vector<uint32_t> rows);
  /// The beams that are seen from `place` (m, world) in directions within `box`, in the order of
  /// the rows.
  SeenBeams seen_from(const Vec3& place, const Eigen::AlignedBox3f& box) const;

 private:
  struct Cell {
    Eigen::AlignedBox3d box;      ///< Around the ends; m, world.
    std::vector<uint32_t> beams;  ///< Places in `rows_`.
    std::vector<Vec3> ends;       ///< Where these beams end; m, world.
  };
  static bool may_be_within(const Cell& cell, const Vec3& place, const Eigen::AlignedBox3f& box);

  const BeamLog& log_;
  std::vector<uint32_t> rows_;
  std::vector<Cell> cells_;
  std::vector<uint32_t> misses_;  ///< Places in `rows_`.
};

}  // namespace underbrush::metrics
