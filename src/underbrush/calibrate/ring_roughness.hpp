/// \file
/// The roughness of a log along its rings.
#pragma once
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::calibrate {

/// The absolute second differences |r₁ − 2 r₂ + r₃| of the ranges of three beams that follow each
/// other in a ring of a scan and all hit. They measure the roughness of simulated surfaces, which
/// range errors of single beams do not.
class RingRoughness {
 public:
  /// Adds beams in firing order. Where `groups` is not empty it has one group a beam, and only
  /// beams of one group count together. Of several echoes of a beam the first counts.
  void add(const BeamLog& beams, std::span<const uint8_t> groups = {});

  /// Returns the number of differences in a group.
  size_t count(uint8_t group = 0) const;
  /// Returns a quantile of the differences in a group, m; NaN without any.
  double quantile(double q, uint8_t group = 0) const;
  double median(uint8_t group = 0) const { return quantile(0.5, group); }
  /// Returns exp(mean log(d + 5 mm)) − 5 mm of the differences d in a group, m; NaN without any. It
  /// weighs smooth and rough parts alike, where the median of a log of both lies between them.
  double geometric_mean(uint8_t group = 0) const;

 private:
  struct Last {
    uint32_t scan = 0;
    uint8_t group[2] = {};
    float range_m[2] = {kMiss, kMiss};  ///< Ranges of the last beam and of the beam before it.
  };
  std::unordered_map<uint16_t, Last> last_;  ///< The last beams of each ring.
  std::vector<std::vector<float>> differences_;
};

}  // namespace underbrush::calibrate
