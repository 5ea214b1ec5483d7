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

/// A run of rays in single precision, with the angles by which they are ordered.
struct FloatRays {
  /// For each ray: origin relative to `centre` (3), direction (3), and the two halves of its key.
  alignas(64) float row[kBatchRays][8];
  /// The azimuth relative to the first ray, in quarter turns from −2 to 2, to about 0.001.
  alignas(64) float azimuth[kBatchRays];
  alignas(64) float sin_elevation[kBatchRays];  ///< Third component of the direction.
  double centre[3];  ///< Centre of the origins, relative to the tree's origin, m.
  float azimuth_low, azimuth_high, sin_elevation_low,
      sin_elevation_high;  ///< Extremes of `azimuth` and `sin_elevation`.
  float spread;            ///< Greatest length of a relative origin, m.
};

/// Computes an order of the rays (up to `kBatchRays`), such that runs of kPacketRays rays make
/// compact tiles on the sphere of directions. `order` gets the numbers of the rays. Returns the
/// side of a tile, rad.
float order_by_direction(const FloatRays& rays, std::span<uint32_t> order);

/// The order of a run of rays. A sensor that turns repeats its pattern of directions, up to the
/// azimuth; then the last order serves again. The class is as large as a run.
class DirectionOrder {
 public:
  /// Returns an order of the first `count` rays (1 to `kBatchRays`), after which kPacketRays copies
  /// of the last number follow. It holds until the next call.
  const uint32_t* of(const FloatRays& rays, size_t count);

 private:
  bool fits(const FloatRays& rays, size_t count) const;

  alignas(64) float azimuth_[kBatchRays], sin_elevation_[kBatchRays];
  uint32_t order_[kBatchRays + kPacketRays];
  size_t count_ = 0;
  float slack_rad_ = 0;  // the largest allowed angle of directions from those that were ordered
};

}  // namespace underbrush::trace
