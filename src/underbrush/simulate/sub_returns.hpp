/// \file
/// This file collects the returns of a beam's sub-rays.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/core/rng.hpp"
#include "underbrush/trace/element_math.hpp"

namespace underbrush::simulate {

/// Draws the ranges of sub-rays as `drawn_on_ray` does with a `QuickNormal`, t ~ N(t_i, σ_i²)
/// ([deschaud12] eq. 2–3); m, NaN where a sub-ray met nothing. All spans are equally long, and
/// `keys` are overwritten.
void draw_ranges(std::span<const trace::Intersection> met, const trace::RangeLimits& limits,
                 std::span<uint64_t> keys, std::span<float> range_m);

/// The sub-rays of one beam that met something, in columns. The memory is used again for the next
/// beam.
class SubReturns {
 public:
  /// Makes room for `most` sub-rays.
  explicit SubReturns(size_t most);

  /// Takes the sub-rays that met something. `range_m` and `weight` have one entry per sub-ray, and
  /// `traced` has the traced sub-ray that each stands for; without it, all are traced.
  void collect(std::span<const float> range_m, std::span<const float> weight,
               std::span<const uint32_t> traced = {});

  size_t size() const { return size_; }
  /// The number of the traced sub-ray.
  std::span<const uint32_t> sub_ray() const { return {sub_ray_.data(), size_}; }
  std::span<const float> range_m() const { return {range_m_.data(), size_}; }
  std::span<const float> weight() const { return {weight_.data(), size_}; }
  /// Columns for the caller to fill: the reflection factors, and the receiver's signals.
  std::span<float> factor() { return {factor_.data(), size_}; }
  std::span<float> signal() { return {signal_.data(), size_}; }

 private:
  size_t size_ = 0;
  std::vector<uint32_t> sub_ray_;
  std::vector<float> range_m_, weight_, factor_, signal_;
};

}  // namespace underbrush::simulate
