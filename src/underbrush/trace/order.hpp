/// \file
/// This file orders rays for tracing, so that those that point alike come together.
#pragma once
#include <cstdint>
#include <span>

namespace underbrush::trace {

/// The number of rays of a packet.
inline constexpr size_t kPacketRays = 128;
/// The number of rays that are ordered at a time. Longer queries are cut into runs of this length.
inline constexpr size_t kBatchRays = 8192;

/// A run of rays in single precision, with what orders them.
struct FloatRays {
  /// For each ray: origin relative to `centre` (3), direction (3), and the two halves of its key.
  alignas(64) float row[kBatchRays][8];
  /// A measure of the azimuth relative to the first ray. It rises with the azimuth and lies in [−2,
  /// 2); a quarter turn is 1.
  alignas(64) float azimuth[kBatchRays];
  alignas(64) float sin_elevation[kBatchRays];  ///< Third component of the direction.
  double centre[3];  ///< Centre of the origins, relative to the tree's origin, m.
  float azimuth_low, azimuth_high, sin_elevation_low,
      sin_elevation_high;  ///< Extremes of `azimuth` and `sin_elevation`.
  float spread;            ///< Greatest length of a relative origin, m.
};

/// Computes an order of the rays (up to `kBatchRays`), such that runs of kPacketRays rays make
/// compact tiles on the sphere of directions. `order` gets the numbers of the rays.
void order_by_direction(const FloatRays& rays, std::span<uint32_t> order);

}  // namespace underbrush::trace
