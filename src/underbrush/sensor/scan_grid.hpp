/// \file
/// The directions of the beams without a return in a scan whose grid of rings and firings is known.
#pragma once
#include <cstddef>

namespace underbrush::sensor {

/// How the points of a scan are stored, row by row.
struct GridShape {
  size_t rows, columns;
  bool by_ring;  ///< Whether a row is a ring, and not a firing.
};

/// Computes the directions of all beams of a scan from its hits, unit vectors in the sensor's
/// frame. `xyz` has three coordinates a beam, m, which are not finite or all zero without a return,
/// and `direction` receives as many. The elevation of a beam is that of its ring, and its azimuth
/// is the sum of those of ring and firing. Both are means over the hits, weighted by the squares of
/// their ranges because lasers do not start at the origin. Rings and firings without a hit are
/// between those that have some; rings beyond them follow a line through the others. Returns false
/// where no such grid explains the hits to half a degree.
bool grid_directions(const double* xyz, const GridShape& shape, double* direction);

}  // namespace underbrush::sensor
