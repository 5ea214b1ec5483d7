/// \file
/// Distances of places, and means of values.
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

namespace underbrush::sites {

/// Returns the mean; NaN of no values.
double mean_of(std::span<const double> values);
/// Returns the standard deviation of a sample; NaN of fewer than two values.
double deviation_of(std::span<const double> values);

/// Returns the distance (m) of each place of `from` to the nearest of `to` at another place;
/// infinite where there is none.
std::vector<double> nearest_distances(std::span<const Eigen::Vector2d> from,
                                      std::span<const Eigen::Vector2d> to);

}  // namespace underbrush::sites
