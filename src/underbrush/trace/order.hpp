/// \file
/// This file orders rays for tracing, so that those that point alike come together.
#pragma once
#include <cstdint>
#include <span>

namespace underbrush::trace {

/// The number of rays of a packet.
inline constexpr size_t kTogether = 128;
/// The number of rays that are ordered at a time. Longer queries are cut into runs of this length.
inline constexpr size_t kOrdered = 8192;

/// A run of rays in single precision, with what orders them.
struct Unfolded {
  /// For each ray: origin relative to `centre` (3), direction (3), and the two halves of its key.
  alignas(64) float row[kOrdered][8];
  /// A measure of the azimuth relative to the first ray. It rises with the azimuth and lies in [−2,
  /// 2); a quarter turn is 1.
  alignas(64) float turn[kOrdered];
  alignas(64) float up[kOrdered];  ///< Third component of the direction.
  double centre[3];                ///< Centre of the origins, relative to the tree's origin, m.
  float turn_low, turn_high, up_low, up_high;  ///< Extremes of `turn` and `up`.
  float spread;                                ///< Greatest length of a relative origin, m.
};

/// Computes an order of the rays (up to `kOrdered`), such that runs of kTogether rays make compact
/// tiles on the sphere of directions. `order` gets the numbers of the rays.
void order_by_direction(const Unfolded& rays, std::span<uint32_t> order);

}  // namespace underbrush::trace
