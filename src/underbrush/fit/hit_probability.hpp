/// \file
/// Hit probabilities from the beams of a log.
#pragma once
#include <functional>
#include <span>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::fit {

/// Counts before any beam was seen: p_hit = (hits + a) / (hits + misses + a + b).
struct HitPrior {
  double a = 0, b = 1;
};

/// Options of `count_hits`.
struct CreditOptions {
  /// Opaque until beams are seen to pass: tuned, as [tallavajhula18] tunes θ, for the least packet
  /// error + 2(1 − F1). Table I of the paper has (0, 1) for ellipsoids and (1, 2) for triangles.
  HitPrior ellipsoid{50, 0};
  HitPrior triangle{1e4, 0};  ///< The earth lets nothing through; misses there are grazing beams.
  double max_residual_for_hit_m =
      0.75;  ///< A triangle explains a point nearer than this along the beam.
};

/// What one beam says of the elements it meets, in order of range: `hit` is the index of the
/// element that explains the measured point (met.size() if none), `misses` the number of leading
/// elements that the beam passed through.
struct Credit {
  size_t hit, misses;
};

/// The crediting rule of [tallavajhula18]: the first ellipsoid whose Mahalanobis distance to the
/// measured point is below τ (a triangle: whose residual is below `max_residual_for_hit_m`) gets
/// the hit and all met before it a miss; where none explains the point, all met before the range
/// get a miss; a beam without a return gives a miss to all. `met` in order of range, `range_m` =
/// kMiss for a miss.
Credit credit(const elements::Model& model, std::span<const trace::Met> met, double range_m,
              const CreditOptions& options);

/// Fills hits, misses and p of all elements of `model` from all beams of `source`. Elements that no
/// beam met keep the prior's mean. `progress(done, total)` may be empty.
void count_hits(elements::Model& model, BeamSource& source, const CreditOptions& options,
                const std::function<void(size_t, size_t)>& progress = {});

}  // namespace underbrush::fit
