/// \file
/// The sums from which the scores of a set of beams are made. This file is internal to the module.
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/metrics/summary.hpp"

namespace underbrush::metrics {

/// The mean over packets of the mean over a packet's consecutive beams.
struct PacketMeans {
  uint64_t packet = ~uint64_t(0);
  double sum = 0, total = 0;
  size_t n = 0, packets = 0;
  void add(uint64_t p, double error) {
    if (p != packet) close();
    packet = p;
    sum += error;
    ++n;
  }
  void close() {
    if (n) total += sum / double(n), ++packets;
    sum = 0;
    n = 0;
  }
};

/// The sums over a set of beams.
struct Sums {
  Summary counts;
  PacketMeans packets;
  std::vector<float> range_errors;
  double nll = 0, crps = 0, capped = 0;
  size_t likelihoods = 0;
  double cloud[2] = {0, 0}, chamfer[2] = {0, 0};
  size_t points[2] = {0, 0};

  /// Returns the scores; takes `range_errors`.
  Summary finish();
};

}  // namespace underbrush::metrics
