#include "underbrush/metrics/predictive.hpp"

#include <cmath>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::metrics {
namespace {

// The end of the table of `excess`, beyond which the value is below 1e−15.
constexpr size_t kEnd = 8;

// Computes E|x + Z| − x = 2 (φ(x) − x Φ(−x)) for x ≥ 0 and a standard normal Z. It interpolates
// values and slopes of a table by a cubic, with an error of 1e−11.
double excess(double x) {
  constexpr size_t kPerUnit = 128;
  struct Table {
    double value[kEnd * kPerUnit + 1], slope[kEnd * kPerUnit + 1];
    Table() {
      for (size_t k = 0; k <= kEnd * kPerUnit; ++k) {
        const double at = double(k) / kPerUnit, tail = std::erfc(at / M_SQRT2);  // 2 Φ(−x)
        value[k] = std::sqrt(2 / M_PI) * std::exp(-0.5 * at * at) - at * tail;
        slope[k] = -tail / kPerUnit;
      }
    }
  };
  static const Table table;
  const double place = x * kPerUnit;
  if (!(place < kEnd * kPerUnit)) return 0;
  const size_t k = size_t(place);
  const double t = place - double(k), u = 1 - t;
  return u * u * ((1 + 2 * t) * table.value[k] + t * table.slope[k]) +
         t * t * ((1 + 2 * u) * table.value[k + 1] - u * table.slope[k + 1]);
}

// Computes E|X| of X ~ N(mean, variance).
double mean_absolute(double mean, double variance) {
  const double size = std::abs(mean);
  if (!(variance > 0) || mean * mean >= kEnd * kEnd * variance) return size;
  const double sigma = std::sqrt(variance);
  return size + sigma * excess(size / sigma);
}

}  // namespace

double return_probability(const trace::RangeMixture& p) {
  constexpr trace::OutlierShares kOutliers = trace::kReportedOutliers;
  return kOutliers.explained() * (1 - p.miss) + kOutliers.hit;
}

double negative_log_likelihood(const trace::RangeMixture& p, double range_m, double max_range_m) {
  constexpr trace::OutlierShares kOutliers = trace::kReportedOutliers;
  return -std::log(kOutliers.explained() * p.likelihood(range_m) +
                   kOutliers.likelihood(range_m != kMiss, max_range_m));
}

double crps(const trace::RangeMixture& p, double range_m, double max_range_m) {
  const double z = range_m == kMiss ? max_range_m : range_m;
  double to_z = p.miss * std::abs(max_range_m - z), among = 0;
  for (size_t i = 0; i < p.components.size(); ++i) {
    const auto& a = p.components[i];
    const double variance = a.sigma_m * a.sigma_m;
    to_z += a.weight * mean_absolute(a.t_m - z, variance);
    among += a.weight * a.weight * mean_absolute(0, 2 * variance);
    among += 2 * a.weight * p.miss * mean_absolute(a.t_m - max_range_m, variance);
    for (size_t j = 0; j < i; ++j) {
      const auto& b = p.components[j];
      among +=
          2 * a.weight * b.weight * mean_absolute(a.t_m - b.t_m, variance + b.sigma_m * b.sigma_m);
    }
  }
  return to_z - 0.5 * among;
}

}  // namespace underbrush::metrics
