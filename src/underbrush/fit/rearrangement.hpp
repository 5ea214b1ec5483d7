/// \file
/// Ellipsoids put where they explain most: redundant ones removed or merged, bad ones split.
#pragma once
#include "underbrush/fit/element_sums.hpp"

namespace underbrush::fit {

/// Options of `rearranged`.
struct RearrangementOptions {
  double least_hits = 0.5;  ///< An ellipsoid with fewer soft hits is redundant.
  double share = 0.3;       ///< Most merges at a time, as a share of the ellipsoids.
  /// Most that a merge may cost the points, nats; ten parameters are saved by it.
  double largest_cost = 5;
  double split_share = 0.5;  ///< Splits for each ellipsoid that was removed or merged away.
  double split_hits = 16;    ///< Fewest soft hits of an ellipsoid that is split.
};

/// The model without ellipsoids of hardly any hits; with pairs of nearest neighbours merged
/// (moments kept, and the optical mass κ |Σ|^½), those first that cost least,
///   n ln n/|Σ|^½ of both − that of the merged;
/// and with the ellipsoids split in two along their longest axis whose beams are explained worst in
/// all, Σ r (−log f − its mean). Never more ellipsoids than before.
elements::Model rearranged(const elements::Model& model, const ElementSums& sums,
                           const RearrangementOptions& options);

/// The ellipsoid with the moments of two, weighted by `hits`.
elements::Ellipsoid merged(const elements::Ellipsoid& a, double hits_a,
                           const elements::Ellipsoid& b, double hits_b);

/// The two halves of an ellipsoid along its longest axis; together they have its moments.
std::array<elements::Ellipsoid, 2> halves(const elements::Ellipsoid& e);

}  // namespace underbrush::fit
