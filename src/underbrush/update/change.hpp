/// \file
/// The test whether the ellipsoids of a model have changed, from the trials of earlier and of later
/// beams.
#pragma once
#include <span>

#include "underbrush/credit/beta_prior.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::update {

/// Correlation c of the trials of one element in one log. The beams of a log meet an element from
/// few places, so n of them inform about its mean hit probability as much as n / (1 + (n − 1) c)
/// independent beams, at most 20.
inline constexpr double kTrialCorrelation = 0.05;

/// The evidence (natural logarithm of a Bayes factor) above which one ellipsoid has changed by its
/// own trials: 1000 to 1.
inline constexpr double kChangeEvidence = 6.9;
/// The evidence above which the ellipsoids of a place have changed together. It is larger, because
/// the hit probabilities of a whole place differ between viewpoints.
inline constexpr double kPlaceEvidence = 20;

/// Side of the cells of places, m. The evidence of an ellipsoid is that of the 3 × 3 × 3 cells
/// about it.
inline constexpr double kChangeCellM = 0.5;

/// Computes the logarithm of the Bayes factor of two hit probabilities, one of the earlier trials
/// (h hits, m misses) and one of the later (h', m'), against one of both:
///
///     K = B(h + 1, m + 1) B(h' + 1, m' + 1) / B(h + h' + 1, m + m' + 1),
///
/// the ratio of the marginal likelihoods under even priors on [0, 1]. Both pairs of counts are
/// first shortened to independent ones by `kTrialCorrelation`. Without trials on one side it is 0.
double change_evidence(const credit::Trials& earlier, const credit::Trials& later);

/// The share of hits below which a place is free, if at least so many beams met it.
struct FreeSpace {
  double below = 0.05;
  uint32_t beams = 20;
};

/// The trials that describe an ellipsoid now.
struct CurrentTrials {
  credit::Trials trials;
  bool changed = false;  ///< Whether the latest log contradicts the earlier ones.
  bool gone = false;     ///< Whether its place has become free since beams ended there.
};

/// Adds the trials of one more log to those of ellipsoids.
///
/// An ellipsoid has few trials, as clusters have few points, but things come and go as a whole. The
/// evidence is therefore summed over the ellipsoids of a neighbourhood (`kChangeCellM`) whose
/// shares of hits changed in the same direction. An ellipsoid agrees with the sum if its own
/// evidence is positive, or if it was hit no more. An ellipsoid has changed
///
/// - where it agrees, the sum is above `kPlaceEvidence`, and the place is free by the later trials
///   of all that agree (it went) or was free by the earlier ones (it came);
/// - or where its own evidence is above `kChangeEvidence`.
///
/// Its later trials then replace the earlier ones; other trials are added. It is gone where its
/// place has become free; so are the ellipsoids there that no later beam met. It stays so until
/// beams end there again.
void add_trials(std::span<const elements::Ellipsoid> ellipsoids,
                std::span<const credit::Trials> later, const FreeSpace& free,
                std::span<CurrentTrials> of);

}  // namespace underbrush::update
