/// \file
/// This file rearranges the ellipsoids of a model: it removes or merges redundant ones and splits
/// those that explain their beams badly.
#pragma once
#include <array>
#include <vector>

#include "underbrush/likelihood/element_sums.hpp"

namespace underbrush::likelihood {

/// The options of `rearranged`.
struct RearrangementOptions {
  double least_hits = 0.5;  ///< An ellipsoid with fewer soft hits is removed.
  double share = 0.3;       ///< Largest number of merges at a time, as a share of the ellipsoids.
  /// The largest loss of the points' log-likelihood at a merge, nats. A merge saves ten parameters.
  double largest_cost = 5;
  double split_share = 0.5;  ///< Splits for each ellipsoid that was removed or merged away.
  double split_hits = 16;    ///< Least soft hits of an ellipsoid that is split.
};

/// Rearranges the ellipsoids of a model and returns the result, which never has more ellipsoids
/// than before:
///
/// - ellipsoids with fewer than `least_hits` soft hits are removed;
/// - pairs of near neighbours are merged, the cheapest first, for as long as a merge costs little.
/// A
///   merge keeps the moments and the optical mass κ |Σ|^½, and costs what n ln(n / |Σ|^½) of the
///   two exceeds that of the merged ellipsoid;
/// - the ellipsoids whose beams are explained worst in total, by Σ r (−log f − its mean), are split
///   in two along their longest axis.
elements::Model rearranged(const elements::Model& model, const ElementSums& sums,
                           const RearrangementOptions& options);

/// Computes the ellipsoid with the joint moments of two ellipsoids, weighted by their hits.
elements::Ellipsoid merged(const elements::Ellipsoid& a, double hits_a,
                           const elements::Ellipsoid& b, double hits_b);

/// Splits an ellipsoid along its longest axis into two halves that together have its moments.
std::array<elements::Ellipsoid, 2> halves(const elements::Ellipsoid& e);

}  // namespace underbrush::likelihood
