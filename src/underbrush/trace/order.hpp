/// \file
/// The order in which rays are traced: those that point alike together.
#pragma once
#include <cstdint>
#include <span>

namespace underbrush::trace {

/// Rays of a packet.
inline constexpr size_t kTogether = 128;
/// Rays that are ordered at a time; more are cut into runs of so many.
inline constexpr size_t kOrdered = 8192;

/// Rays in single precision.
struct Unfolded {
  /// Of each ray: origin relative to `centre`, direction, the two halves of its key.
  alignas(64) float row[kOrdered][8];
  /// A measure of the azimuth from that of the first ray: rises with it, in [−2, 2).
  alignas(64) float turn[kOrdered];
  alignas(64) float up[kOrdered];              ///< The direction's third component.
  double centre[3];                            ///< Relative to the tree's origin.
  float turn_low, turn_high, up_low, up_high;  ///< Extremes of turn and up.
  float spread;                                ///< Greatest length of a relative origin.
};

/// Writes to `order` the numbers of the rays (up to `kOrdered`) so that runs of kTogether make
/// compact tiles on the sphere of directions.
void order_by_direction(const Unfolded& rays, std::span<uint32_t> order);

}  // namespace underbrush::trace
