/// \file
/// Points on their way into an octree, with coordinates in whole units, so that the cell of a point
/// is exact on every level.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "underbrush/serve/octree.hpp"

namespace underbrush::serve {

/// m; the unit of coordinates, about a micrometre.
inline constexpr double kUnitM = 0x1p-20;
/// Bits of `kNodeCells`.
inline constexpr uint32_t kCellBits = 6;
static_assert(kNodeCells == 1u << kCellBits);
/// The deepest level that a tree may have.
inline constexpr uint32_t kDeepestLevel = 32;

/// A return of a log. Coordinates are in units, relative to the octree's origin, and relative to
/// its lowest corner once the root is known.
struct OctreePoint {
  std::array<int64_t, 3> at{};
  float intensity = 0, time_s = 0;
  uint32_t row = 0;
  uint16_t ring = 0, label = 0;
  uint8_t echo = 0;
};

/// The order in which points are taken: a bijection of 32 bits, so that two rows never tie.
constexpr uint32_t rank_of(uint32_t row) {
  uint32_t x = row;
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

/// The cube of a tree's root: its lowest corner in units, and its side of 2^bits units.
struct OctreeRoot {
  std::array<int64_t, 3> low{};
  uint32_t bits = kCellBits;

  /// The level whose cells are single units, or `kDeepestLevel`.
  uint32_t deepest() const { return std::min(bits - kCellBits, kDeepestLevel); }
  /// The number of the cell within a node of this level that holds a point.
  uint32_t cell(const OctreePoint& p, uint32_t level) const {
    const uint32_t shift = bits - level - kCellBits;
    const auto part = [&](size_t c) { return uint32_t(p.at[c] >> shift) & (kNodeCells - 1); };
    return part(0) | part(1) << kCellBits | part(2) << (2 * kCellBits);
  }
  /// The octant of a node of this level that holds a point.
  uint32_t octant(const OctreePoint& p, uint32_t level) const {
    const uint32_t shift = bits - level - 1;
    const auto part = [&](size_t c) { return uint32_t(p.at[c] >> shift) & 1u; };
    return part(0) | part(1) << 1 | part(2) << 2;
  }
  /// Side of a node of this level, m.
  double side_m(uint32_t level) const { return std::ldexp(kUnitM, int(bits - level)); }
};

}  // namespace underbrush::serve
