/// \file
/// This file traces the sub-rays of beams: all of them, or a few first and the others where these
/// disagree.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/simulate/dynamic_world.hpp"
#include "underbrush/simulate/sub_ray_bundle.hpp"
#include "underbrush/simulate/sub_returns.hpp"

namespace underbrush::simulate {

/// The sub-rays of some beams after tracing, one beam after the other. The memory is used again.
class TracedBeams {
 public:
  /// The sub-rays of one beam: what each met, and its share of the energy.
  struct Beam {
    std::span<const Ray> rays;
    std::span<const trace::Intersection> met;
    std::span<const uint64_t> keys;  ///< For the ranges that are drawn.
    std::span<const float> weight;
  };
  Beam operator[](size_t beam) const;
  size_t rays() const { return rays_.size(); }

 private:
  friend class SubRayTracer;
  std::vector<Ray> rays_, probe_rays_;
  std::vector<uint64_t> keys_, probe_keys_;
  std::vector<trace::Intersection> met_, probe_met_;
  std::vector<double> time_s_;
  std::vector<size_t> first_;  ///< The first sub-ray of each beam, and the end.
  std::vector<uint8_t> all_;   ///< Whether all sub-rays of a beam were traced.
  std::span<const float> all_weight_, probe_weight_;
  std::unique_ptr<SubReturns> returns_;
};

/// Traces the sub-rays of beams.
///
/// Where the matter of the world is drawn once, 13 of 26 or more sub-rays may speak for all
/// (`same_m` > 0). These probes, in the middle and as far apart as may be, are traced first. Where
/// all of them miss, or all return within `same_m` of each other, they are the beam, and each has
/// the energy of the sub-rays that are nearest to it. Elsewhere the other sub-rays are traced, too.
/// Where matter much finer than the footprint stops the share p of the light, all probes pass it by
/// chance in (1 − p)¹³ of the beams.
class SubRayTracer {
 public:
  /// `world` must outlive it. `same_m` (m): 0 = always trace all sub-rays.
  /// `sway_s`: as in `Options`.
  SubRayTracer(const DynamicWorld& world, const sensor::BeamShape& beam,
               std::span<const sensor::SubRay> sub_rays, uint64_t seed, double same_m,
               double sway_s = 0);

  /// The largest number of sub-rays of a beam.
  size_t most() const { return all_.size(); }
  /// Traces the beams [begin, end) of a log whose first beam has the number `first_beam`.
  void trace(const BeamLog& beams, size_t first_beam, size_t begin, size_t end,
             TracedBeams& out) const;

 private:
  Ray axis_of(const BeamLog& beams, size_t i, uint64_t key) const;
  void trace_all(const BeamLog& beams, size_t first_beam, size_t begin, size_t end,
                 TracedBeams& out) const;
  void trace_probes(const BeamLog& beams, size_t first_beam, size_t begin, size_t end,
                    TracedBeams& out) const;
  void key_matter(double time_s, std::span<const Ray> rays, std::span<uint64_t> keys,
                  std::span<trace::Intersection> met) const;
  bool probes_agree(double time_s, size_t at, const trace::RangeLimits& limits,
                    TracedBeams& out) const;

  const DynamicWorld& world_;
  uint64_t seed_, matter_;
  bool once_;  ///< Whether the matter of the world is drawn once.
  double encoder_step_rad_, same_m_, sway_s_;
  SubRayBundle all_;
  std::unique_ptr<SubRayBundle> probes_, rest_;  ///< Together they are `all_`, in this order.
};

}  // namespace underbrush::simulate
