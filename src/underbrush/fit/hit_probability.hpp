/// \file
/// Hit probabilities from the beams of a log: who is credited, and what p follows from few counts.
#pragma once
#include <functional>
#include <span>
#include <string>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/fit/beta_prior.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::fit {

/// Options of `count_hits`.
struct CreditOptions {
  /// `first`: the rule of [tallavajhula18]; `mahalanobis`: that of [deschaud12] eq. 1; `best`:
  /// ours. See `credit`.
  std::string rule = "first";
  double tau_m = 2;  ///< τ_m of `mahalanobis`; at most the model's τ counts.
  /// How p of an ellipsoid follows from its counts: `plain`, hits / (hits + misses), 1 where there
  /// is none; `prior`, with the counts of `ellipsoid` added; `empirical_bayes`, with a Beta prior
  /// fitted to the log for each class and each region.
  std::string estimator = "prior";
  /// Opaque until beams are seen to pass: tuned, as [tallavajhula18] tunes θ, for the least packet
  /// error + 2(1 − F1). Table I of the paper has (0, 1) for ellipsoids and (1, 2) for triangles.
  HitPrior ellipsoid{50, 0};
  HitPrior triangle{1e4, 0};  ///< The earth lets nothing through; misses there are grazing beams.
  double max_residual_for_hit_m =
      0.75;              ///< A triangle explains a point nearer than this along the beam.
  double region_m = 32;  ///< `empirical_bayes`: side of the square regions.
  /// `empirical_bayes`: a class has a prior of its own in a region with as many ellipsoids that a
  /// beam met; else the one of the class in the whole log, and else the one of all ellipsoids.
  size_t region_elements = 100;
};

/// What a beam says of an element that it meets.
enum class Credit : uint8_t { kNothing, kHit, kMiss };

/// Replaces `out` with what one beam says of each element of `met` (in any order; `range_m` =
/// kMiss for a beam without a return, which is a miss for all). An ellipsoid explains the measured
/// point if its Mahalanobis distance to it is below a threshold, a triangle if its residual is
/// below `max_residual_for_hit_m`.
///
/// `first`: the first that explains the point (threshold τ) gets the hit, all before it a miss;
/// where none does, all met before the range get a miss. One beam, one hit: overlapping ellipsoids
/// share them.
///
/// `best`: likewise, but the hit goes to the one of those that explain the point whose range
/// density N(z; t, σ²) is greatest there: the likeliest by the ray model. Where elements overlap
/// along a beam, `first` takes the points of the farther ones for the nearest.
///
/// `mahalanobis`: each element by itself. Ellipsoids farther from the beam than τ_m say nothing;
/// those that explain the point (threshold τ_m) get a hit, the others met before the range a miss:
/// n and m of the permeability ρ = m / (m + n), p = 1 − ρ.
void credit(const elements::Model& model, std::span<const trace::Intersection> met, double range_m,
            const CreditOptions& options, std::vector<Credit>& out);

/// Fills hits, misses and p of all elements of `model` from all beams of `source`. Elements that no
/// beam met keep the prior's mean (1 under `plain`). `progress(done, total)` may be empty. Throws
/// `std::invalid_argument` for an unknown rule or estimator and for options out of range.
void count_hits(elements::Model& model, BeamSource& source, const CreditOptions& options,
                const std::function<void(size_t, size_t)>& progress = {});

/// Fills p of all elements from their counts.
void estimate_hit_probabilities(elements::Model& model, const CreditOptions& options);

/// Names of the crediting rules.
std::vector<std::string> credit_rules();
/// Names of the estimators of p.
std::vector<std::string> hit_estimators();

}  // namespace underbrush::fit
