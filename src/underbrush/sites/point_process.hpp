/// \file
/// The point process of a site: the places of its plants, given their sizes.
#pragma once
#include <span>
#include <vector>

#include "underbrush/sites/pair_process.hpp"

namespace underbrush::sites {

/// Returns the expected number of pairs of such points that are spread evenly over a window.
PairSteps even_pairs(const Window& window, std::span<const MarkedPoint> points, uint64_t seed);

/// Fits the process to points in a window, by maximum likelihood: the expected number of pairs in
/// each interval, and the expected mean place of each class of at least 10 points, are those that
/// the points have. The expectations come from simulations of the process in the same window, so
/// that its border needs no correction, and the parameters follow them by stochastic approximation
/// ([moyeed91]). The same seed gives the same bits.
PointProcess fit_process(const Window& window, std::span<const MarkedPoint> points, uint64_t seed);

/// Draws the places of `points` anew, in a window that is not empty, by Metropolis's algorithm with
/// that many steps for each point. The same seed gives the same bits.
void draw_places(const PointProcess& process, const Window& window, std::span<MarkedPoint> points,
                 uint64_t seed, size_t sweeps = 60);

}  // namespace underbrush::sites
