/// \file
/// Learns the inclinations of the leaves of a log.
#pragma once
#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::calibrate {

/// The result of `learn_leaf_angles`.
struct LeafAngleReport {
  size_t cells = 0, hits = 0;  ///< Numbers of cells of vegetation and of returns from them.
  double chi = 1;              ///< The most likely χ of `LeafAngleDistribution` by the log alone.
  /// The estimating function for spherical leaves, in its standard errors; positive for flat
  /// leaves.
  double deviation = 0;
  bool used = false;  ///< Whether the model has this χ instead of spherical leaves.
};

/// Sets `leaf_angles` of the model by the returns of a log from vegetation. In a cell of a grid (1
/// m), the beams of one inclination have ρ G(θ) L returns on average, where L is their path in the
/// cell up to their returns and ρ the density there. Let n be the returns and w = G L the weighted
/// path of one inclination of one random half of the beams, and N and W their sums over all
/// inclinations of the other half. n W − N w is 0 on average whatever ρ is, without the bias that
/// few beams in a cell would have. The sum of these, each with ∂ ln G / ∂ ln χ minus its mean over
/// the cell and over the paths that the beams would have without returns, is an estimating function
/// for ln χ, of which the root is taken.
///
/// Cells of vegetation are those with at least six returns that do not lie on a plane or a line,
/// and whose lower side is above the ground of the model. The variance of the estimating function
/// is the sum of the squares of the contributions of the cells. Leaves stay spherical if it differs
/// from 0 by less than three standard errors for them; otherwise ln χ has a normal prior of mean 0
/// and standard deviation 1. About a quarter of a million beams of the log are used, up to 30 m and
/// as far as the beams of the sensor that `info` names are at most 3 cm wide: a wider beam meets
/// leaves beside its axis, the more the farther away, which has the effect of another inclination.
/// The beams of a log without a sensor count as narrow. Leaves stay spherical without the misses of
/// the log, whose paths count, too. They also stay spherical where under 5 % of the first beams of
/// the log (65 536 or more) are within 45° of the vertical, or under 5 % are not, because such a
/// log holds too little about inclinations.
LeafAngleReport learn_leaf_angles(elements::Model& model, BeamSource& log, const LogInfo& info,
                                  double min_range_m);

}  // namespace underbrush::calibrate
