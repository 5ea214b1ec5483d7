#include "underbrush/metrics/reliability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace underbrush::metrics {

void Reliability::add(double probability, bool returned) {
  const double p = std::clamp(probability, 0.0, 1.0);
  Bin& bin = bins_[std::min(size_t(p * double(kBins)), kBins - 1)];
  ++bin.beams;
  bin.returns += returned;
  bin.predicted += p;
}

size_t Reliability::beams() const {
  size_t n = 0;
  for (const Bin& b : bins_) n += b.beams;
  return n;
}

double Reliability::error() const {
  double sum = 0;
  for (const Bin& b : bins_) sum += std::abs(b.predicted - double(b.returns));
  return beams() ? sum / double(beams()) : std::numeric_limits<double>::quiet_NaN();
}

double Reliability::bias() const {
  double sum = 0;
  for (const Bin& b : bins_) sum += b.predicted - double(b.returns);
  return beams() ? sum / double(beams()) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace underbrush::metrics
