#include "studies/range_histogram.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "underbrush/core/check.hpp"

namespace underbrush::studies {
namespace {

/// Returns the mean of `difference(k)` over the bins that hold anything.
template <class F>
double mean_over_used(const RangeHistograms& h, const F& difference) {
  double sum = 0;
  size_t used = 0;
  for (size_t k = 0; k < h.a.count.size(); ++k) {
    if (h.a.count[k] + h.b.count[k] == 0) continue;
    sum += difference(k);
    ++used;
  }
  return sum / double(used);
}

}  // namespace

uint64_t RangeHistogram::total() const {
  return std::accumulate(count.begin(), count.end(), uint64_t(0));
}

double RangeHistograms::largest_difference() const {
  double most = 0;
  const double n = double(a.total()), m = double(b.total());
  for (size_t k = 0; k < a.count.size(); ++k) {
    most = std::max(most, std::abs(double(a.count[k]) / n - double(b.count[k]) / m));
  }
  return most;
}

double RangeHistograms::mean_difference() const {
  const double n = double(a.total()), m = double(b.total());
  return mean_over_used(
      *this, [&](size_t k) { return std::abs(double(a.count[k]) / n - double(b.count[k]) / m); });
}

double RangeHistograms::mean_count_difference() const {
  return mean_over_used(
      *this, [&](size_t k) { return std::abs(double(a.count[k]) - double(b.count[k])); });
}

RangeHistograms range_histograms(std::span<const double> a, std::span<const double> b, double bin_m,
                                 double from_m) {
  require(!a.empty() && !b.empty(), "range histograms: a cloud without points");
  require(std::isfinite(from_m), "range histograms: the first bound is not finite");
  require(bin_m > 0 && std::isfinite(bin_m), "range histograms: the bin must be positive");
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const std::span<const double> side : {a, b}) {
    for (const double r : side) {
      require(std::isfinite(r) && r >= 0, "range histograms: a range that is not finite");
      least = std::min(least, r);
      most = std::max(most, r);
    }
  }
  RangeHistogram h;
  h.bin_m = bin_m;
  const auto bin_of = [&](double r) { return std::floor((r - from_m) / bin_m); };
  const double first = bin_of(least);
  h.first_m = first * bin_m + from_m;
  const double bins = bin_of(most) - first + 1;
  require(bins <= 1e7, "range histograms: too many bins");
  h.count.assign(size_t(bins), 0);
  RangeHistograms out{h, h};
  for (const double r : a) ++out.a.count[size_t(bin_of(r) - first)];
  for (const double r : b) ++out.b.count[size_t(bin_of(r) - first)];
  return out;
}

}  // namespace underbrush::studies
