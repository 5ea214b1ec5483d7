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
#include "underbrush/simulate/probe_plane.hpp"
#include "underbrush/simulate/sub_ray_bundle.hpp"

namespace underbrush::simulate {

/// The sub-rays of some beams after tracing, one beam after the other. The memory is used again.
class TracedBeams {
 public:
  /// `world` must outlive it.
  explicit TracedBeams(const DynamicWorld& world) : matter_(world) {}

  /// The sub-rays of one beam: the range at which each met something (m, NaN for nothing), its
  /// share of the energy, and the traced one that it stands for, whose ray and intersection it has.
  /// `traced` is empty where all are traced.
  struct Beam {
    std::span<const Ray> rays;
    std::span<const trace::Intersection> met;
    std::span<const float> range_m;
    std::span<const float> weight;
    std::span<const uint32_t> traced;
  };
  Beam operator[](size_t beam) const;
  /// The number of sub-rays traced.
  size_t rays() const { return traced_; }

 private:
  friend class SubRayTracer;
  struct SubRays {
    void resize(size_t n);
    size_t size() const { return rays.size(); }
    /// Copies sub-rays of another to `at`.
    void copy(size_t at, const SubRays& from, size_t begin, size_t count);
    std::vector<Ray> rays;
    std::vector<uint64_t> keys;
    std::vector<trace::Intersection> met;
    std::vector<float> range_m;
  };
  /// The place of a beam's sub-rays: its probes alone, a place in `plane_m_`, or one in `all_`.
  struct Place {
    enum class Kind { kProbes, kPlane, kAll } kind = Kind::kProbes;
    uint32_t number = 0;
  };

  MatterAt matter_;
  SubRays probes_, rest_, all_;
  std::vector<float> plane_m_;  ///< Ranges of beams whose probes lie on a plane.
  std::vector<Place> place_;    ///< The place of each beam.
  std::vector<double> time_s_;  ///< Times of the beams in `all_`.
  std::span<const float> all_weight_, probe_weight_;
  std::span<const uint32_t> nearest_probe_;
  size_t traced_ = 0;
};

/// Traces the sub-rays of beams.
///
/// Where the matter of the world is drawn once, 13 of 26 or more sub-rays may stand for all of
/// them (`same_m` > 0). These probes, in the middle and as far apart as possible, are traced first.
/// If all of them miss, or all return within `same_m` of each other, they alone make the beam, and
/// each has the energy of the sub-rays that are nearest to it. If all return within a tenth of
/// `same_m` of one plane, the other sub-rays have the range of that plane (`ProbePlane`) and the
/// element that the nearest probe met. Otherwise the other sub-rays are traced, too. If matter much
/// finer than the footprint stops the share p of the light, all probes pass it by chance in
/// (1 − p)¹³ of the beams.
class SubRayTracer {
 public:
  /// `world` must outlive it. `same_m` (m): 0 = always trace all sub-rays.
  /// `sway_s`: as in `Options`.
  SubRayTracer(const DynamicWorld& world, const sensor::BeamShape& beam,
               std::span<const sensor::SubRay> sub_rays, uint64_t seed, double same_m,
               double sway_s = 0);

  /// The largest number of sub-rays of a beam, and the number that is traced first.
  size_t most() const { return all_.size(); }
  size_t first() const { return probes_ ? probes_->size() : all_.size(); }
  /// Traces the beams [begin, end) of a log whose first beam has the number `first_beam`.
  void trace(const BeamLog& beams, size_t first_beam, size_t begin, size_t end,
             TracedBeams& out) const;

 private:
  Ray axis_of(const BeamLog& beams, size_t i, uint64_t key) const;
  void trace_all(const BeamLog& beams, size_t first_beam, size_t begin, size_t end,
                 TracedBeams& out) const;
  void trace_probes(const BeamLog& beams, size_t first_beam, size_t begin, size_t end,
                    TracedBeams& out) const;
  void end_in_unknown(size_t beams, const trace::RangeLimits& limits,
                      TracedBeams::SubRays& s) const;
  void find(std::span<const double> time_s, const trace::RangeLimits& limits, MatterAt& matter,
            TracedBeams::SubRays& sub_rays) const;
  void lend_returns(size_t beam, TracedBeams::SubRays& probes) const;
  TracedBeams::Place::Kind look(std::span<const float> probe_m, const trace::RangeLimits& limits,
                                std::span<float> plane_m) const;

  const DynamicWorld& world_;
  uint64_t seed_, matter_;
  bool once_;  ///< Whether the matter of the world is drawn once.
  double encoder_step_rad_, same_m_, sway_s_;
  SubRayBundle all_;
  std::unique_ptr<SubRayBundle> probes_, rest_;  ///< Together they are `all_`, in this order.
  std::unique_ptr<ProbePlane> plane_;
};

}  // namespace underbrush::simulate
