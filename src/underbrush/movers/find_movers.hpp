/// \file
/// This file finds the returns of things that moved while a log was recorded, from the log alone.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/movers/mover_options.hpp"

namespace underbrush::movers {

/// Returns for each row of a log whether it is a return of something that moved.
///
/// A return is compared with scans before and after its own. In each of them its place held matter,
/// was empty, or was not visible (`PlaceState`). If the place was empty in the outermost scans
/// before or after, the matter there has come or gone. Single leaves appear so by chance.
/// Candidates therefore count only as a group that is solid in its own scan, has at least
/// `least_points` returns, and has few returns among them whose places were never empty. Returns
/// beside a group join it if their places were visible in no other scan.
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
