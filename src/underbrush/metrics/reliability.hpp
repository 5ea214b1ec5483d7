/// \file
/// This file compares predicted probabilities of a return with the shares of beams that returned.
#pragma once
#include <array>
#include <cstddef>

namespace underbrush::metrics {

/// A reliability curve: beams in bins of equal width by the probability of a return that a model
/// predicts, with the share of them that returned. A calibrated model has the same share as
/// probability in each bin.
class Reliability {
 public:
  static constexpr size_t kBins = 20;
  struct Bin {
    size_t beams = 0, returns = 0;
    double predicted = 0;  ///< Sum of the probabilities.
  };

  /// Adds a beam with the probability of a return in [0, 1], and whether it returned.
  void add(double probability, bool returned);
  const std::array<Bin, kBins>& bins() const { return bins_; }
  size_t beams() const;
  /// The expected calibration error: the mean over beams of |share of returns − mean probability|
  /// of their bin; NaN without beams.
  double error() const;
  /// The mean probability minus the share of returns, over all beams; NaN without beams.
  double bias() const;

 private:
  std::array<Bin, kBins> bins_{};
};

}  // namespace underbrush::metrics
