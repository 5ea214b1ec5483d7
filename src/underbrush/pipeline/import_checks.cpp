#include "underbrush/pipeline/import_checks.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "underbrush/pipeline/check_values.hpp"

namespace underbrush::pipeline {

size_t coarse_times(const PointScan& scan) {
  constexpr size_t kEnough = 100, kMost = 8;  // points; times
  if (scan.time_s.size() < kEnough) return 0;
  std::set<double> times;
  for (const double t : scan.time_s) {
    if (std::isfinite(t)) times.insert(t);
    if (times.size() > kMost) return 0;
  }
  return times.size();
}

std::string warning_of_greatest_range(const PointScan& scan, double max_range_m) {
  constexpr double kSame = 1e-5, kRounding = 1e-3, kShare = 0.01;
  constexpr size_t kFewest = 20;
  double greatest = 0;
  for (const Vec3f& p : scan.point) {
    if (is_return(p)) greatest = std::max(greatest, p.cast<double>().norm());
  }
  size_t returns = 0, same = 0;
  for (const Vec3f& p : scan.point) {
    if (!is_return(p)) continue;
    ++returns;
    same += p.cast<double>().norm() >= greatest * (1 - kSame) - kRounding;
  }
  if (same < kFewest || double(same) < kShare * double(returns)) return "";
  if (max_range_m > 0 && std::abs(max_range_m - greatest) <= kSame * greatest + kRounding)
    return "";
  const std::string range = text_of("%.6g", greatest);
  return std::to_string(same) + " of " + std::to_string(returns) +
         " returns of the first scan are at its greatest range, " + range +
         " m: are they beams without a return? Then --max-range " + range + " makes them misses";
}

std::string warning_of_ranges(const PointScan& scan) {
  constexpr double kFar = 1000;  // m
  std::vector<double> range;
  for (const Vec3f& p : scan.point) {
    if (is_return(p)) range.push_back(double(p.norm()));
  }
  const double half = median(std::move(range));
  if (half < kFar) return "";
  return "half of the points are " + text_of("%.0f", half) +
         " m and more from the sensor: are they in mm? Then --unit mm";
}

}  // namespace underbrush::pipeline
