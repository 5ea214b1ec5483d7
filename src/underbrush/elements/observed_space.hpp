/// \file
/// The space that the beams of a log crossed, and the expected density of matter in the rest.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "underbrush/core/cells.hpp"

namespace underbrush::elements {

/// Numbers of beams that crossed the cells of a part of space, a cube of `kSide` cells.
struct ObservedBlock {
  static constexpr int kSide = 8;
  static constexpr size_t kCells = size_t(kSide) * kSide * kSide;

  Cell3 at;                             ///< Its lower corner, in blocks.
  std::array<uint8_t, kCells> beams{};  ///< Beams by cell, at most 255; x fastest, then y.

  /// The block that holds a cell, and the index of the cell in it.
  static Cell3 of(const Cell3& cell) {
    return {cell.x >> 3, cell.y >> 3, cell.z >> 3};  // rounded down
  }
  static size_t index(const Cell3& cell) {
    return size_t(cell.z & 7) * 64 + size_t(cell.y & 7) * 8 + size_t(cell.x & 7);
  }
};

/// The number of beams that were lost where they went below the ground in a square of the plane.
struct LostBeams {
  Cell2 at;  ///< The square, of the side `ObservedSpace::kSquareM`.
  uint32_t beams = 0;
};

/// A map of the space that the beams of a log crossed ("observed"), with the density of matter in
/// the rest ("unknown").
///
/// In unknown space a beam ends with the probability κ per metre of its way, which depends on the
/// height above the ground and on the range. Beyond the ground of the model the ground goes on at
/// the height of its nearest part. Near the ground (below `kGroundM`) κ counts per metre of the
/// beam's fall. There a beam returns with a probability that depends on the range and on the beams
/// that were lost there; else it meets no ground. In squares (`kSquareM`) with ground of the model
/// nothing else is met near it.
struct ObservedSpace {
  /// Edges of the heights above the ground (m) and of the ranges (m) of `density_per_m`. The first
  /// and the last interval of the heights have no end, and so has the last one of the ranges.
  static constexpr std::array<double, 11> kHeightsM{-2, -1, -0.5, 0, 0.5, 1, 2, 4, 8, 16, 32};
  static constexpr std::array<double, 6> kRangesM{5, 10, 20, 40, 60, 80};
  static constexpr size_t kHeights = kHeightsM.size() + 1, kRanges = kRangesM.size() + 1;

  static constexpr double kSquareM = 4;    ///< Side of the squares of `lost`, m.
  static constexpr double kGroundM = 0.5;  ///< A beam is near the ground below this height, m.

  double cell_m = 1;  ///< Side of the cells.
  double top_m =
      2 * kHeightsM.back();           ///< Height above the ground beyond which there is no matter.
  std::vector<ObservedBlock> blocks;  ///< Blocks in the order of `at`; all other cells are unknown.
  std::array<std::array<float, kRanges>, kHeights> density_per_m{};  ///< κ, 1/m.
  std::vector<LostBeams> lost;  ///< Squares in the order of `at`; others lost no beam.
  /// The probability by range that a beam which comes near the ground returns.
  std::array<float, kRanges> ground_returns{1, 1, 1, 1, 1, 1, 1};

  /// The memory of the blocks, bytes.
  size_t bytes() const { return blocks.size() * sizeof(ObservedBlock); }
  /// The number of the interval of a height (m) and of a range (m).
  static size_t height_interval(double height_m);
  static size_t range_interval(double range_m);
  /// Adds the beams of another map, whose cells are of the same size.
  void add(const ObservedSpace& other);
  /// Throws `std::invalid_argument` where values are not finite or blocks are not in their
  /// order, or lie too far from each other for tables of the places between them.
  void check() const;
};

}  // namespace underbrush::elements
