/// \file
/// The order in which rays are traced: those that point alike together.
#pragma once
#include <cstdint>
#include <span>

namespace underbrush::trace {

/// Rays of a packet.
inline constexpr size_t kPacketRays = 128;
/// Rays that are ordered at a time; more are cut into runs of so many.
inline constexpr size_t kBatchRays = 8192;

/// Rays in single precision.
struct FloatRays {
  /// Of each ray: origin relative to `centre`, direction, the two halves of its key.
  alignas(64) float row[kBatchRays][8];
  /// A measure of the azimuth from that of the first ray: rises with it, in [−2, 2).
  alignas(64) float azimuth[kBatchRays];
  alignas(64) float sin_elevation[kBatchRays];  ///< The direction's third component.
  double centre[3];                             ///< Relative to the tree's origin.
  float azimuth_low, azimuth_high, sin_elevation_low, sin_elevation_high;  ///< Extremes of the two.
  float spread;  ///< Greatest length of a relative origin.
};

/// Writes to `order` the numbers of the rays (up to `kBatchRays`) so that runs of kPacketRays make
/// compact tiles on the sphere of directions.
void order_by_direction(const FloatRays& rays, std::span<uint32_t> order);

}  // namespace underbrush::trace
