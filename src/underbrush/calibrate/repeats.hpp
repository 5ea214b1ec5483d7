/// \file
/// Beams of a sensor that stands still, which repeat their directions from scan to scan.
#pragma once
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::calibrate {

/// The number of pairs below which nothing is learnt from them.
inline constexpr size_t kLeastPairs = 500;
/// m; the least noise that `range_noise_of` returns, because logs round their ranges.
inline constexpr double kLeastNoiseM = 0.002;

/// Pairs of returns by their numbers in a log.
using BeamPairs = std::vector<std::pair<size_t, size_t>>;

/// Returns of successive scans from one place (within 5 cm and 0.05°), and those of them that
/// repeat the direction of one of the scan before in the same ring (within 0.05°).
struct Repeats {
  bool stands = false;  ///< Whether successive scans of the log are from one place.
  BeamLog beams;
  BeamPairs pairs;
};

/// Finds repeats in runs of four scans that are spread over the log. Reads the log up to the last
/// of them and keeps up to 120 000 beams. A log without such scans is not read, unless it does not
/// list its scans.
Repeats repeats_of(BeamSource& log, uint64_t seed);

/// Estimates σ of the sensor's range (m) from the lower quartile of the differences of pairs, which
/// is that of flat and solid things where a quarter of the pairs are on such: q₁(|Δ|) = 0.319 √2 σ.
/// What else differs from scan to scan, such as the play of an encoder before a slanted surface,
/// counts as noise. Empty with fewer than `kLeastPairs`.
std::optional<double> range_noise_of(const Repeats& repeats);

}  // namespace underbrush::calibrate
