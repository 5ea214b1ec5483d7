/// \file
/// The clock of a recording: the times of scans that a recorder rounded, put back on a steady
/// clock.
#pragma once
#include <optional>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::io {

/// The clock that was fitted to the rounded times of scans.
struct ScanClock {
  double step_s = 0;          ///< The times had been rounded to multiples of this, up to an offset.
  double period_s = 0;        ///< Mean spacing of scans that are one revolution apart, s.
  double residual_rms_s = 0;  ///< RMS of given minus fitted times, s; of the fitted scans.
  size_t fitted = 0;          ///< Number of scans that got another time.
  size_t kept = 0;            ///< Number of scans whose times no steady clock explains.
  bool poses_follow = false;  ///< Whether poses got the fitted times, too (`poses_follow_clock`).
  std::vector<double> time_s;  ///< One for each given time, ascending; s.
};

/// Fits a clock to the times (s, ascending) of the scans of a spinning lidar.
///
/// The times t_k count as rounded if at least 80 % of them lie within an eighth of a step q about
/// one phase of the step, for the largest q of 50, 25, 20, 10, 5, 2, 1 and 0.5 ms that is at most a
/// quarter of the period. Scan k then is revolution n_k, the sum of the spacings in whole periods,
/// so that dropped scans count. The clock is the straight line t = a + b n, by least squares
/// without the times that lie off by more than 0.75 q. Where one line does not explain the times,
/// it is a local line about each scan, over 256 scans, 128, 64 or 32. A clock explains the times if
/// 95 % of them lie within 0.75 q of it, with an RMS of at most 0.36 q; rounding alone gives q/√12
/// = 0.29 q.
///
/// Scans on both sides of a pause (more than ten periods, or a spacing that is off whole periods by
/// more than two steps) have clocks of their own. Returns nothing where the times are not rounded,
/// where nothing is to be corrected (RMS below 0.05 q), or where no part of at least eight scans
/// follows a steady clock.
std::optional<ScanClock> fit_scan_clock(const std::vector<double>& times_s);

/// Returns whether the poses that carry a recording's rounded times belong to the true instants of
/// the scans, as poses found from the scans do, and not to the rounded times, as those of a GPS/INS
/// do. The times under which the motion is steadier are the poses' own: the mean change of velocity
/// from one pose to the next is compared. `poses` have the rounded times; `fitted_s` has a time of
/// the clock for each.
bool poses_follow_clock(const std::vector<StampedPose>& poses, const std::vector<double>& fitted_s);

}  // namespace underbrush::io
