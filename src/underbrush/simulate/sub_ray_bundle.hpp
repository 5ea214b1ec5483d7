/// \file
/// This file makes the sub-rays of a beam about any axis.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/sensor/beam.hpp"

namespace underbrush::simulate {

/// The sub-rays of a beam shape in the axes of the beam, prepared for rotation to rays of the
/// world. They equal those of `sensor::RayMaker` up to rounding, at a few operations per ray.
class SubRayBundle {
 public:
  /// Prepares at least one sub-ray. Throws `std::invalid_argument` for none and for an invalid
  /// shape.
  SubRayBundle(const sensor::BeamShape& shape, std::span<const sensor::SubRay> places);

  size_t size() const { return weight_.size(); }
  /// The share of the beam's energy of each sub-ray.
  std::span<const float> weight() const { return weight_; }

  /// Computes the rays of a beam. `rays` has room for `size()` rays.
  void spread(const sensor::BeamAxes& axes, Ray* rays) const;
  /// Computes the keys of the sub-rays. The first one has the beam's own key, and the others have
  /// independent keys.
  void keys(uint64_t beam_key, uint64_t* keys) const;

 private:
  /// The six numbers of each ray in turn, three of the origin and three of the direction, as
  /// coefficients of the beam's axis, right and up.
  std::vector<double> along_, right_, up_;
  std::vector<float> weight_;
};

}  // namespace underbrush::simulate
