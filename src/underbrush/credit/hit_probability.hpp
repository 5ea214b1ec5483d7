/// \file
/// This file estimates hit probabilities from the beams of a log: which elements each beam credits
/// with a hit or a miss, and how p follows from the counts.
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/credit/beta_prior.hpp"
#include "underbrush/credit/mesh_noise.hpp"
#include "underbrush/credit/trial_times.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush {
/// The elements of a model that explain the returns of a log, and the quantities that are derived
/// from them: hit probabilities, noise, classes.
namespace credit {

/// The options of `count_hits`.
struct CreditOptions {
  /// The crediting rule, `first` ([tallavajhula18]), `mahalanobis` ([deschaud12] eq. 1) or `best`;
  /// see `credit`.
  std::string rule = "first";
  /// Prior counts of an ellipsoid, which are added to its hits and misses. With (0, 0) p is hits /
  /// (hits + misses), or 1 without counts, so that the mean density of a turbid medium is unbiased.
  /// Prior hits make F1 greater and matter too dense. Table I of [tallavajhula18] has (0, 1) for
  /// ellipsoids and (1, 2) for triangles.
  HitPrior ellipsoid{0, 0};
  /// Prior counts of a triangle. Ground is opaque; its misses come from grazing beams.
  HitPrior triangle{1e4, 0};
  double max_residual_for_hit_m =
      0.75;  ///< A triangle explains a point nearer than this along the beam, m.
};

/// The credit that one beam gives to an element that it meets.
enum class Credit : uint8_t { kNothing, kHit, kMiss };

/// Computes the credit of one beam for each element of `met`, which may be in any order. `range_m`
/// is the measured range (m); a beam without a return (kMiss) gives every element a miss. The
/// result replaces `out`, with one entry for each entry of `met`.
///
/// An ellipsoid explains the measured point if its Mahalanobis distance to it is below a threshold,
/// a triangle if its residual along the beam is below `max_residual_for_hit_m`. The rules differ in
/// the choice of the element that gets the hit:
///
/// - `first` [tallavajhula18]: the first element that explains the point (threshold τ) gets the
///   hit, and all before it a miss. Where no element explains the point, all elements before the
///   measured range get a miss. One beam gives at most one hit, which overlapping ellipsoids
///   compete for.
/// - `best`: among the elements that explain the point (threshold τ), the one with the greatest
///   range density N(z; t, σ²) there gets the hit, and all before it a miss. Where elements overlap
///   along a beam, this avoids giving the points of farther elements to the nearest one.
/// - `mahalanobis` [deschaud12] eq. 1: each element is judged by itself. Ellipsoids farther from
///   the beam than τ_m get nothing; elements that explain the point (threshold τ_m) get a hit;
///   others before the measured range get a miss. The counts n of hits and m of misses give the
///   permeability ρ = m / (m + n) and p = 1 − ρ.
void credit(const elements::Model& model, std::span<const trace::Intersection> met, double range_m,
            const CreditOptions& options, std::vector<Credit>& out);

/// The residuals of the returns that triangles were credited with.
struct CreditedResiduals {
  MeshResiduals ground, surface;
};

/// The hits and misses that beams give the elements of a model.
struct Tally {
  std::vector<Trials> of;  ///< The trials of each element.
  /// The times of the trials of each ellipsoid, by its place in the model's vector.
  std::vector<TrialTimes> times;
  CreditedResiduals residuals;
  std::optional<double> zero_s;  ///< The time from which `times` count: that of the first beam.

  /// Starts without beams. Throws `std::invalid_argument` for an unknown rule and for options out
  /// of range.
  Tally(const elements::Model& model, const CreditOptions& options);
  /// Adds all beams of `source`. `world` is that of the model, whose elements all have p = 1;
  /// `progress(done, total)` may be empty.
  void add(const trace::World& world, BeamSource& source, const CreditOptions& options,
           const std::function<void(size_t, size_t)>& progress = {});
};

/// Counts the hits and misses of all elements of `model` over all beams of `source`, estimates p
/// from them, and returns the tally. Elements that no beam met get the prior's mean.
/// `progress(done, total)` may be empty. Throws `std::invalid_argument` for an unknown rule and for
/// options out of range.
Tally count_hits(elements::Model& model, BeamSource& source, const CreditOptions& options,
                 const std::function<void(size_t, size_t)>& progress = {});

/// Estimates p of all elements from the counts that the model holds.
void estimate_hit_probabilities(elements::Model& model, const CreditOptions& options);

/// The names of the crediting rules.
std::vector<std::string_view> credit_rules();

}  // namespace credit
}  // namespace underbrush
