/// \file
/// The order in which rays are traced: those that point alike together.
#pragma once
#include <cstdint>
#include <span>

namespace underbrush::trace {

/// Rays that are ordered at a time; more are cut into runs of so many.
inline constexpr size_t kOrdered = 8192;

/// Rays in single precision, in columns.
struct Columns {
  alignas(64) float direction[3][kOrdered];
  alignas(64) float offset[3][kOrdered];  ///< Origins relative to `centre`.
  /// A measure of the azimuth from that of the first ray: rises with it, in [−2, 2).
  alignas(64) float turn[kOrdered];
  double centre[3];                            ///< Relative to the tree's origin.
  float turn_low, turn_high, up_low, up_high;  ///< Extremes of turn and of direction[2].
  float spread;                                ///< Greatest length of an offset.
};

/// Writes to `order` the numbers of the rays (up to `kOrdered`) so that runs of 64 make compact
/// tiles on the sphere of directions.
void order_by_direction(const Columns& rays, std::span<uint32_t> order);

}  // namespace underbrush::trace
