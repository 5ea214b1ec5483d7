#include "underbrush/metrics/leaf_inclination.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "underbrush/core/check.hpp"
#include "underbrush/metrics/normals.hpp"

namespace underbrush::metrics {
namespace {

constexpr size_t kNeighbours = 30;

}  // namespace

double LeafInclination::epsilon() const {
  return std::hypot(mean_rad - kRealMean, sigma_rad - kRealSigma);
}

double LeafInclination::gaussian_gap() const {
  double below = 0, gap = 0;
  for (size_t k = 0; k < kBins && sigma_rad > 0; ++k) {
    below += double(count[k]) / double(points);
    const double end = double(k + 1) * M_PI / double(kBins);
    const double normal = 0.5 * std::erfc((mean_rad - end) / (sigma_rad * M_SQRT2));
    gap = std::max(gap, std::abs(below - normal));
  }
  return sigma_rad > 0 ? gap : 1;
}

LeafInclination leaf_inclination(std::span<const Vec3f> cloud) {
  require(cloud.size() >= kNeighbours, "leaf inclination: fewer than 30 points");
  LeafInclination out;
  out.points = cloud.size();
  const double n = double(cloud.size());
  double squares = 0;
  for (const Vec3f& normal : normals(cloud, kNeighbours)) {
    const double angle = std::acos(std::clamp(double(normal.z()), -1.0, 1.0));
    out.mean_rad += angle / n;
    squares += angle * angle / n;
    ++out.count[std::min(LeafInclination::kBins - 1,
                         size_t(angle / M_PI * double(LeafInclination::kBins)))];
  }
  out.sigma_rad = std::sqrt(std::max(0.0, squares - out.mean_rad * out.mean_rad));
  return out;
}

double LogRegression::count_at(double epsilon) const {
  return b > 0 ? std::exp((a - epsilon) / b) : std::numeric_limits<double>::infinity();
}

LogRegression log_regression(std::span<const double> count, std::span<const double> epsilon) {
  require(count.size() == epsilon.size() && count.size() >= 3,
          "regression: three pairs are needed");
  const double n = double(count.size());
  double x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  for (size_t i = 0; i < count.size(); ++i) {
    x += std::log(count[i]) / n;
    y += epsilon[i] / n;
  }
  for (size_t i = 0; i < count.size(); ++i) {
    const double u = std::log(count[i]) - x, v = epsilon[i] - y;
    xx += u * u, xy += u * v, yy += v * v;
  }
  require(xx > 0, "regression: all counts are the same");
  LogRegression out;
  out.b = -xy / xx;
  out.a = y + out.b * x;
  out.r2 = yy > 0 ? xy * xy / (xx * yy) : 1;
  return out;
}

}  // namespace underbrush::metrics
