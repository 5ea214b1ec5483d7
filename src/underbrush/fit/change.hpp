/// \file
/// The test whether an element of a model is still what it was, from earlier and later beams.
#pragma once
#include "underbrush/fit/beta_prior.hpp"

namespace underbrush::fit {

/// Correlation c of the trials of one element in one log. Beams of a log see an element from few
/// places, so n of them tell as much of its mean hit probability as n / (1 + (n − 1) c) independent
/// ones, at most 20.
inline constexpr double kTrialCorrelation = 0.05;

/// The evidence (natural logarithm of the Bayes factor) above which an element has changed: 1000 to
/// 1.
inline constexpr double kChangeEvidence = 6.9;

/// Computes the logarithm of the Bayes factor of two hit probabilities, one of the earlier trials
/// (h hits, m misses) and one of the later (h', m'), against one of both:
///
///     K = B(h + 1, m + 1) B(h' + 1, m' + 1) / B(h + h' + 1, m + m' + 1),
///
/// the ratio of the marginal likelihoods under even priors on [0, 1]. Both pairs of counts are first
/// shortened to independent ones by `kTrialCorrelation`. Without trials on one side it is 0.
double change_evidence(const Trials& earlier, const Trials& later);

/// The trials that describe an element now.
struct CurrentTrials {
  Trials trials;
  bool changed = false;
};

/// Adds later trials to earlier ones where one hit probability explains both. Where the evidence
/// says that the element has changed (`kChangeEvidence`), the later trials alone count.
CurrentTrials with_later(const Trials& earlier, const Trials& later);

}  // namespace underbrush::fit
