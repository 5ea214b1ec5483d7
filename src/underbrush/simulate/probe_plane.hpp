/// \file
/// This file finds the ranges of all sub-rays of a beam from a few that lie on one plane.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/sensor/beam.hpp"
#include "underbrush/trace/element_math.hpp"

namespace underbrush::simulate {

/// The plane through the returns of a beam's first sub-rays, its probes.
///
/// A sub-ray o + r·d of the beam's frame ends on the plane n·x = 1 at r = (1 − n·o) / (n·d). The
/// plane is that of least squares of n·(d + o/r) − 1/r over the probes that returned. Each other
/// sub-ray has the range of the plane plus the offset of the nearest probe.
class ProbePlane {
 public:
  static constexpr size_t kMostProbes = 32;

  /// The first `probes` of the places in the beam, at most `kMostProbes`, are probes.
  ProbePlane(const sensor::BeamShape& shape, std::span<const sensor::SubRay> places, size_t probes);

  /// Computes the ranges of all sub-rays (m, NaN where the plane is beyond the limits) if the
  /// probes lie on a plane, and returns whether they do: five or more returned, none of them is
  /// farther than `most_off_m` (m) from the plane, and the plane is beyond the limits for all
  /// others. `probe_m` has the ranges of the probes, NaN for nothing, and `range_m` room for all
  /// sub-rays.
  bool fill(std::span<const float> probe_m, double most_off_m, const trace::RangeLimits& limits,
            std::span<float> range_m) const;

  /// The probe that is nearest to each sub-ray.
  std::span<const uint32_t> nearest() const { return nearest_; }
  /// The probe with a range that is nearest to a probe; there must be one.
  uint32_t nearest_return(uint32_t probe, std::span<const float> probe_m) const;

 private:
  size_t probes_;
  std::vector<Ray> ray_;  ///< In the beam's frame: along, right, up.
  std::array<std::vector<float>, 3> origin_, direction_;
  std::vector<uint32_t> nearest_;
  std::vector<uint32_t> by_distance_;  ///< For each probe all probes, the nearest first.
};

}  // namespace underbrush::simulate
