/// \file
/// Square and cubic cells of a regular grid by their integer coordinates, and maps keyed by them.
#pragma once
#include <cmath>
#include <compare>
#include <cstdint>
#include <unordered_map>

#include "underbrush/core/pose.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush {

/// A cell [x, x + 1) × [y, y + 1) of the plane, in sides.
struct Cell2 {
  int32_t x = 0, y = 0;
  auto operator<=>(const Cell2&) const = default;
};

/// A cell [x, x + 1) × [y, y + 1) × [z, z + 1) of space, in sides.
struct Cell3 {
  int32_t x = 0, y = 0, z = 0;
  auto operator<=>(const Cell3&) const = default;
};

/// The number of the interval of length `side_m` that holds a coordinate, counted from 0 at 0.
inline int32_t cell_index(double at_m, double side_m) {
  const double at = at_m / side_m;
  const auto toward_zero = int32_t(at);
  return toward_zero - int32_t(at < double(toward_zero));  // faster than std::floor
}
/// The cell of side `side_m` that holds a point of the plane.
inline Cell2 cell_of(double x, double y, double side_m) {
  return {cell_index(x, side_m), cell_index(y, side_m)};
}
/// The cell of side `side_m` that holds a point.
inline Cell3 cell_of(const Vec3& p, double side_m) {
  return {cell_index(p.x(), side_m), cell_index(p.y(), side_m), cell_index(p.z(), side_m)};
}

/// Hash of a cell.
struct CellHash {
  size_t operator()(const Cell2& c) const {
    return size_t(mix64(uint64_t(uint32_t(c.x)) << 32 | uint32_t(c.y)));
  }
  size_t operator()(const Cell3& c) const {
    return size_t(mix64((*this)(Cell2{c.x, c.y}) + uint32_t(c.z)));
  }
};

/// Values by cell, for look-ups; the order of iteration means nothing.
template <class Cell, class T>
using CellMap = std::unordered_map<Cell, T, CellHash>;

}  // namespace underbrush
