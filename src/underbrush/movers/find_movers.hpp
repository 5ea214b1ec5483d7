/// \file
/// This file finds the returns of things that moved while a log was recorded, from the log alone.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
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

/// The table of these options.
std::span<const Option<MoverOptions>> mover_options();

/// Tells for each row of a log whether it is a return of something that moved.
///
/// A return is compared with scans before and after its own. In each of them its place held matter,
/// was empty, or was not visible (`Look`). If the place was empty in the outermost scans before or
/// after, the matter there has come or gone. Single leaves appear so by chance. Candidates
/// therefore count only as a group that is solid in its own scan, has at least `least_points`
/// returns, and has few returns among them whose places were never empty. Returns beside a group
/// join it if their places were visible in no other scan.
///
/// The log must have several scans, with poses that agree within `same_m`. An object that stands
/// still in all scans is not found. The function reads the source once, from the beginning, and
/// holds the scans within the longest of `look_s` of each other. `progress(done, total)` counts
/// rows. Throws `std::invalid_argument` for options out of range.
std::vector<uint8_t> find_movers(BeamSource& source, const MoverOptions& options = {},
                                 const std::function<void(size_t, size_t)>& progress = {});

/// Throws `FormatError` with the log's name if it has fewer than two scans, because then nothing
/// can be seen to move. Reads the source from the beginning.
void require_two_scans(BeamSource& source, const std::string& name);

/// Replaces the marks (`kMover`) of a chunk by those of the rows from `first` on.
void mark_movers(const std::vector<uint8_t>& is_mover, size_t first, BeamLog& chunk);

}  // namespace underbrush::movers
