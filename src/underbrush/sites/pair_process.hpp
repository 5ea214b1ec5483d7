/// \file
/// A point process with pairwise interactions, and the pairs of its points.
#pragma once
#include <array>
#include <map>

#include "underbrush/elements/classes.hpp"
#include "underbrush/sites/window.hpp"

namespace underbrush::sites {

/// A plant or a piece of a patch as the process has it.
struct MarkedPoint {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< m, world.
  elements::Class label = elements::Class::kUnknown;
  double radius_m = 0;
};

/// The intervals of the step functions of a pair of points, which count the pairs in each interval.
struct PairSteps {
  static constexpr int kPairsOfKinds = 6;  ///< The kinds are shrub, tree and piece of a patch.
  /// Upper ends (m) of the intervals of distance; beyond the last there is no interaction.
  static constexpr std::array<double, 9> kDistances{0.5, 1, 1.5, 2, 3, 4, 6, 8, 12};
  static constexpr double kReachM = kDistances.back();
  /// The number of intervals of the distance divided by the sum of the radii, of 0.25 each.
  static constexpr int kSpacings = 6;
  static constexpr size_t kIntervals =
      kDistances.size() + kSpacings;  ///< The number for each pair of kinds.

  std::array<double, kPairsOfKinds * kIntervals> values{};

  /// Adds `n` to the intervals that hold the pair: at most two.
  void count(const MarkedPoint& a, const MarkedPoint& b, double distance_m, double n = 1);
};

/// A Gibbs process with pairwise interactions and a given number of points of each class. The
/// density of the places x_i of points with the classes c_i and the radii r_i is
///
///     f(x) ∝ exp( Σ_i b(c_i)·u(x_i) + Σ_k θ_k S_k(x) − (S_k(x) − T_k)² / (2 (T_k + 1)) )
///
/// with the coordinates u relative to the window (`Window::relative`), and the numbers S_k of pairs
/// in the intervals of distance, and of distance over the sum of the radii, for each pair of kinds
/// (`PairSteps`). The last term keeps these numbers near to T_k, as far as those of Poisson's
/// distribution; without it a process of clusters has two states, with clusters and without.
struct PointProcess {
  std::map<elements::Class, Eigen::Vector2d> gradient;  ///< b of each class.
  PairSteps steps;                                      ///< θ.
  /// T over the number of pairs of as many points of those kinds and radii that are spread evenly
  /// over the window: the pair correlation by interval.
  PairSteps correlation;
};

}  // namespace underbrush::sites
