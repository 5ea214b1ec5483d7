#include "studies/verification_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::studies {
namespace {

constexpr double kMeanDistanceM = 0.0031;
constexpr double kAllowanceM = 0.0005;  // m; half a step of the instrument's ranges.
constexpr double kSurveyM = 0.001;      // m; a step of the instrument's ranges.

/// Returns the size of `x` beyond `allowance`, with the sign of `x`.
double beyond(double x, double allowance) {
  return std::copysign(std::max(0.0, std::abs(x) - allowance), x);
}

/// The least and the largest of some values.
struct Extremes {
  double least = INFINITY, most = -INFINITY;
  void add(double x) { least = std::min(least, x), most = std::max(most, x); }
};

}  // namespace

double spread_difference(double variance_a, double freedom_a, double variance_b, double freedom_b) {
  require(freedom_a > 0 && freedom_b > 0, "spread: no degrees of freedom");
  return 0.5 * std::log(variance_a / variance_b) / std::sqrt(0.5 / freedom_a + 0.5 / freedom_b);
}

PlaneDifferences plane_differences(const Plane& simulated, size_t simulated_points,
                                   const Plane& real, size_t real_points, double allowance_m) {
  PlaneDifferences out;
  const double n = double(simulated_points), m = double(real_points);
  out.spread = spread_difference(simulated.variance, n - 3, real.variance, m - 3);
  out.offset = beyond(real.distance(simulated.centre), allowance_m) /
               std::sqrt(simulated.variance / n + real.variance / m);
  for (int axis = 0; axis < 2; ++axis) {
    const Vec3& along = axis == 0 ? real.u : real.v;
    const double slope = -simulated.normal.dot(along) / simulated.normal.dot(real.normal);
    // The slope of the simulated plane is as well known as if its axes were the real one's, and an
    // allowance on both ends of the patch, √12 of its spread apart, tilts it.
    const double variance = real.covariance(axis + 1, axis + 1);
    const double length = std::sqrt(12 * real.variance / (variance * m));
    out.slope[axis] = beyond(slope, 2 * allowance_m / length) /
                      std::sqrt(variance + variance * m / n * simulated.variance / real.variance);
  }
  return out;
}

void add_between(std::vector<Check>& checks, const std::string& what, double value, double low,
                 double high) {
  checks.push_back({what, value, low, false});
  checks.push_back({what, value, high, true});
}

std::vector<Check> pair_checks(const std::string& what, const PairFigures& figures) {
  std::vector<Check> out;
  for (const Registered* by : {&figures.by_icp, &figures.by_corners}) {
    const std::string name = what + (by == &figures.by_icp ? " by ICP, " : " by corners, ");
    out.push_back(
        {name + "mean distance of the patches (m)", by->mean_distance_m(), kMeanDistanceM});
    out.push_back({name + "mean difference of the normalised histograms",
                   by->histograms.mean_difference(), kHistogramShare});
  }
  Extremes spread, offset, slope;
  for (const PatchFigures& p : figures.by_icp.patches) {
    if (p.inner_real_points == 0) continue;
    const PlaneDifferences d = plane_differences(p.inner_simulated, p.inner_simulated_points,
                                                 p.inner_real, p.inner_real_points, kAllowanceM);
    spread.add(d.spread);
    offset.add(d.offset);
    for (const double s : d.slope) slope.add(s);
  }
  for (const auto& [name, e] :
       {std::pair{"spread", spread}, {"offset", offset}, {"slope", slope}}) {
    const std::string of = fmt::format("{}, {} of a patch against the real one's, ", what, name);
    out.push_back({of + "least (standard errors)", e.least, -kMostErrors, false});
    out.push_back({of + "largest (standard errors)", e.most, kMostErrors});
  }
  return out;
}

std::vector<Check> survey_checks(const std::string& what, const PairFigures& figures,
                                 const Pose& real_from_target) {
  // Points of the target, where the survey puts them and where the registration does.
  const Vec3 there = real_from_target.translation;
  const Vec3 sight = there.normalized();
  std::vector<Check> out;
  add_between(out, what + ", registration against the survey along the line of sight (m)",
              sight.dot(figures.by_icp.real_from_target.translation - there), -kSurveyM, kSurveyM);
  return out;
}

std::vector<NamedFault> faults() {
  return {{"no noise", {0, 0, 0}},
          {"double noise", {2, 0, 0}},
          {"bias of 1 cm", {1, 0.01, 0}},
          {"mirror tilted by 0.5°", {1, 0, 0.5 * M_PI / 180}}};
}

void add_fault(const std::string& place, const std::string& fault, std::span<const Check> sound,
               std::span<const Check> faulty, report::Table& table, StudyResult& result) {
  require(sound.size() == faulty.size(), "faults: the checks differ");
  size_t caught = 0;
  std::string first;
  for (size_t k = 0; k < faulty.size(); ++k) {
    if (!sound[k].holds() || faulty[k].holds()) continue;
    if (caught++ == 0) first = verdict(faulty.subspan(k, 1));
  }
  table.rows.push_back({place, fault, std::to_string(caught), first});
  result.figures["faults"][place][fault] = caught;
  result.checks.push_back({fmt::format("{}: checks that catch a simulator with {}", place, fault),
                           double(caught), 1, false});
}

void add_faults(const StudyRun& run, const Solid& target, const Pose& pose, const CloudPair& pair,
                std::span<const Check> sound, StudyResult& result) {
  report::Table table{"Faults on the miniature",
                      "Simulators with a fault, and how many checks of one scan catch them.",
                      {"place", "fault", "checks that fail", "the first of them"},
                      {}};
  for (const NamedFault& f : faults()) {
    CloudPair faulty = pair;
    faulty.simulated = simulated_scan(target, pose, 0, run.seed, f.fault).points;
    const PairFigures figures = compare(target, miniature_patches(), std::move(faulty));
    std::vector<Check> checks = pair_checks("one scan", figures);
    for (const Check& c : survey_checks("one scan", figures, pose.inverse())) checks.push_back(c);
    add_fault("miniature", f.name, sound, checks, table, result);
  }
  result.tables.push_back(std::move(table));
}

}  // namespace underbrush::studies
