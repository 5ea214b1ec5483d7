/// \file
/// The bundle of sub-rays of a beam, placed about any axis.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/sensor/beam.hpp"

namespace underbrush::simulate {

/// Sub-rays in the axes of their beam, ready to be turned into rays of the world: those of
/// `sensor::RayMaker` to rounding, and a few operations a ray.
class SubRayBundle {
 public:
  /// At least one sub-ray. Throws `std::invalid_argument`.
  SubRayBundle(const sensor::BeamShape& shape, std::span<const sensor::SubRay> places);

  size_t size() const { return weight_.size(); }
  /// Share of the beam's energy of each.
  std::span<const float> weight() const { return weight_; }

  /// The rays of a beam; room for `size()` of them.
  void spread(const sensor::BeamAxes& axes, Ray* rays) const;
  /// Their keys: the first sub-ray has the beam's own, the others decide for themselves.
  void keys(uint64_t beam_key, uint64_t* keys) const;

 private:
  /// Of the six numbers of each ray in turn, origin and direction: its part along the axis, to the
  /// right, upward.
  std::vector<double> along_, right_, up_;
  std::vector<float> weight_;
};

}  // namespace underbrush::simulate
