/// \file
/// Two-sided checks of the study of [kim12]: a simulator falls short if it is better than the
/// instrument as well as if it is worse.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "studies/verification.hpp"

namespace underbrush::studies {

/// A figure may lie this many standard errors from the instrument's. If errors are normal a
/// simulator without a fault leaves these bounds in one of 15 800 figures.
inline constexpr double kMostErrors = 4;

/// Largest difference of the shares of an interval, [kim12] §4.4.1.
inline constexpr double kHistogramShare = 0.001;

/// Returns the difference of two spreads in standard errors: ½ ln(a²/b²) / √(1/2ν_a + 1/2ν_b) for
/// variances a², b² with ν degrees of freedom, which is normal for normal errors (Fisher's z). It
/// is negative where `a` spreads less; −∞ where `a` has no spread.
double spread_difference(double variance_a, double freedom_a, double variance_b, double freedom_b);

/// The differences between a simulated and a real plane, in standard errors.
struct PlaneDifferences {
  double spread = 0;         ///< Spread of the points about their own planes.
  double offset = 0;         ///< Offset of the simulated plane at the centre of its points.
  double slope[2] = {0, 0};  ///< Along the two axes of the real plane.
};
/// Compares two planes. `allowance_m` is subtracted from the size of the offset before it is
/// divided, and from that of a slope over the spread of the points: the error of a registration.
PlaneDifferences plane_differences(const Plane& simulated, size_t simulated_points,
                                   const Plane& real, size_t real_points, double allowance_m);

/// Adds two checks: `low` ≤ `value` ≤ `high`.
void add_between(std::vector<Check>& checks, const std::string& what, double value, double low,
                 double high);

/// Returns the checks of a pair of clouds:
/// - the thresholds of [kim12], mean patch distance 3.1 mm and normalised histograms that differ by
///   0.1 % on average, by both registrations;
/// - spread, offset and slopes of each plane within `kMostErrors`.
std::vector<Check> pair_checks(const std::string& what, const PairFigures& figures);

/// Returns the check of the registration against a survey: the simulated scan must lie where the
/// target was put, within 1 mm along the line of sight. Registration by the clouds takes an offset
/// of the range away; the survey does not.
std::vector<Check> survey_checks(const std::string& what, const PairFigures& figures,
                                 const Pose& real_from_target);

/// A fault and its name.
struct NamedFault {
  const char* name;
  ScannerFault fault;
};
/// Returns a fault of each kind: no noise, double noise, a bias of 1 cm, a tilted mirror.
std::vector<NamedFault> faults();

/// Adds the checks that caught a fault to `table`, and to `result` the check that there is one: a
/// check that holds for the simulator without the fault (`sound`) and fails with it (`faulty`).
void add_fault(const std::string& place, const std::string& fault, std::span<const Check> sound,
               std::span<const Check> faulty, report::Table& table, StudyResult& result);

/// Runs simulators with a fault on one scan of the miniature (`add_fault`). `pair` has the
/// instrument's scan, and `sound` the checks of the simulator without a fault.
void add_faults(const StudyRun& run, const Solid& target, const Pose& pose, const CloudPair& pair,
                std::span<const Check> sound, StudyResult& result);

}  // namespace underbrush::studies
