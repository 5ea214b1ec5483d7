/// \file
/// This file finds the returns of things that moved while a log was recorded, from the log alone.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::movers {

/// The options of `find_movers`.
struct MoverOptions {
  /// s; scans so long before and after its own are asked about a return.
  std::vector<double> look_s{0.1, 0.2, 0.3, 0.5, 0.8, 1.2, 2, 3, 4.5, 6};
  /// A return is a candidate if the outermost scans that know of its place, so many of them on one
  /// side in time, all found the place empty.
  uint32_t least_empty = 3;
  double cell_deg = 0.5;    ///< Width of the cells in which scans are compared.
  double max_range_m = 80;  ///< m; farther returns are not looked at.
  /// m; ranges that differ by no more than the first, plus the second for each metre of range, are
  /// those of one thing; an empty place has twice as much room behind it.
  double same_m = 0.3, same_per_m = 0.01;
  /// Least share of the directions around a candidate that end at its range, in its own scan, as a
  /// mean of its group: a cloud of twigs is no mover.
  double least_solid = 0.5;
  uint32_t least_points = 12;  ///< Least number of candidates that hang together.
  /// Least share of candidates among the returns of a group whose places are known.
  double least_share = 0.6;

  /// Throws `std::invalid_argument` where a value is out of range.
  void check() const;
};

/// Tells for each row of a log whether it is a return of something that moved.
///
/// A return is compared with scans before and after its own: each found matter at its place, or
/// found it empty, or did not see it (`Look`). Where the outermost looks of a side are empty, what
/// was there has come or gone. Leaves look so by chance, one at a time, so candidates count only as
/// a group: solid in their own scan, as large as `least_points`, and with few returns among them
/// whose places were never empty. Returns beside a group whose places no other scan saw join it.
///
/// A log needs poses that agree within `same_m`, and several scans. One that stands still all the
/// time is not found. Reads the source once, from the beginning, and holds the scans within the
/// longest of `look_s` of each other. `progress(done, total)` counts rows. Throws
/// `std::invalid_argument` for options out of range.
std::vector<uint8_t> find_movers(BeamSource& source, const MoverOptions& options = {},
                                 const std::function<void(size_t, size_t)>& progress = {});

/// Throws `FormatError` with the log's name if it has fewer than two scans, because then nothing
/// can be seen to move. Reads the source from the beginning.
void require_two_scans(BeamSource& source, const std::string& name);

/// Replaces the marks (`kMover`) of a chunk by those of the rows from `first` on.
void mark_movers(const std::vector<uint8_t>& is_mover, size_t first, BeamLog& chunk);

}  // namespace underbrush::movers
