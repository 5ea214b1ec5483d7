/// \file
/// The options of the search for moving things, and their table.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/core/option.hpp"

namespace underbrush::movers {

/// The options of `find_movers`.
struct MoverOptions {
  /// s; a return is compared with the scans at these times before and after its own.
  std::vector<double> look_s{0.1, 0.2, 0.3, 0.5, 0.8, 1.2, 2, 3, 4.5, 6};
  /// A return is a candidate if its place was empty in this many scans, the outermost ones before
  /// or after it in which the place was visible.
  uint32_t least_empty = 3;
  double cell_deg = 0.5;    ///< Width of the cells in which scans are compared.
  double max_range_m = 80;  ///< m; farther returns are not examined.
  /// m; ranges that differ by no more than the first, plus the second for each metre of range, are
  /// those of one thing; an empty place has twice as much room behind it.
  double same_m = 0.3, same_per_m = 0.01;
  /// Least share of the directions around a candidate that end at its range, in its own scan, as a
  /// mean of its group: a cloud of twigs is no mover.
  double least_solid = 0.5;
  uint32_t least_points = 12;  ///< Least number of connected candidates.
  /// Least share of candidates among the returns of a group whose places are known.
  double least_share = 0.6;

  /// Throws `std::invalid_argument` where a value is out of range.
  void check() const;
};

/// The table of these options.
std::span<const Option<MoverOptions>> mover_options();

}  // namespace underbrush::movers
