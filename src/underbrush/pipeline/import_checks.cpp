#include "underbrush/pipeline/import_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
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
  constexpr double kSame = 1e-5, kRounding = 1e-3, kShare = 0.01, kLevel = 1e-3;
  constexpr size_t kFewest = 20;
  double greatest = 0;
  for (const Vec3f& p : scan.point) {
    if (is_return(p)) greatest = std::max(greatest, p.cast<double>().norm());
  }
  size_t returns = 0, same = 0;
  double low = INFINITY, high = -INFINITY;  // Heights.
  for (const Vec3f& p : scan.point) {
    if (!is_return(p)) continue;
    ++returns;
    if (p.cast<double>().norm() < greatest * (1 - kSame) - kRounding) continue;
    ++same;
    low = std::min(low, double(p.z()));
    high = std::max(high, double(p.z()));
  }
  const bool circle = high < 0 && high - low < kLevel * greatest;  // The last ring on flat ground.
  if (circle || same < kFewest || double(same) < kShare * double(returns)) return "";
  if (max_range_m > 0 && std::abs(max_range_m - greatest) <= kSame * greatest + kRounding)
    return "";
  const std::string range = text_of("%.6g", greatest);
  return std::to_string(same) + " of " + std::to_string(returns) +
         " returns of the first scan are at its greatest range, " + range +
         " m: are they beams without a return? Then --max-range " + range + " makes them misses";
}

std::string warning_of_ranges(const PointScan& scan) {
  constexpr double kFar = 500, kFarWhole = 100, kMillimetres = 2000, kSteep = 0.7;  // m
  std::vector<double> range, steepness;
  bool whole = true;
  for (const Vec3f& p : scan.point) {
    if (!is_return(p)) continue;
    range.push_back(double(p.norm()));
    steepness.push_back(std::abs(double(p.z())) / range.back());
    whole = whole && p == p.array().floor().matrix();
  }
  const double half = median(std::move(range));
  if (half < (whole ? kFarWhole : kFar) || median(std::move(steepness)) > kSteep) return "";
  return "half of the points are " + text_of("%.0f", half) +
         " m and more from the sensor: are they in mm" +
         (half < kMillimetres ? " or cm? Then --unit mm or --unit cm" : "? Then --unit mm");
}

std::string warning_of_turn(const PointScan& scan, double turn) {
  constexpr size_t kParts = 36;
  constexpr double kEven = 1.2;
  const auto [low, high] = std::minmax_element(scan.time_s.begin(), scan.time_s.end());
  if (low == scan.time_s.end() || !(*high > *low)) return "";
  std::array<std::complex<double>, kParts> facing{};  // Sums of directions, by time.
  for (size_t i = 0; i < scan.size(); ++i) {
    const Vec3f& p = scan.point[i];
    const double at = (scan.time_s[i] - *low) / (*high - *low);
    if (!is_return(p) || !(at >= 0)) continue;
    const auto part = std::min(kParts - 1, size_t(at * double(kParts)));
    facing[part] += std::polar(1.0, std::atan2(double(p.y()), double(p.x())));
  }
  double turned = 0, way = 0;
  for (size_t k = 1; k < kParts; ++k) {
    const double step = std::arg(facing[k] * std::conj(facing[k - 1]));
    turned += step;
    way += std::abs(step);
  }
  if (turned * turn > -M_PI || way > kEven * std::abs(turned)) return "";
  return "by the points' times the sensor turns the wrong way round: do they count back from the "
         "scan's last point? Then --point-times before";
}

}  // namespace underbrush::pipeline
