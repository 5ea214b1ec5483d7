/// \file
/// This file completes the box of an object that was seen from one side, by the prior of the sizes
/// of its class.
#pragma once
#include <array>

#include "underbrush/perception/segment_shape.hpp"

namespace underbrush::perception {

/// A number and its standard deviation.
struct Estimate {
  double mean = 0, sigma = 0;
};

/// The sizes of the objects of a class, as normal distributions (m).
struct SizePrior {
  Vec3 mean_m = Vec3::Zero(), sigma_m = Vec3::Zero();  ///< Length, width, height.
  bool is_known() const { return mean_m.x() > 0; }
};

/// The options of `complete`.
struct CompletionOptions {
  bool enabled = true;
  /// By class; without a known prior a box stays as measured. The defaults are round values of
  /// European traffic.
  std::array<SizePrior, kClassCount> priors{{
      {},
      {{4.5, 1.8, 1.5}, {0.35, 0.1, 0.15}},
      {{5.0, 2.0, 2.2}, {0.6, 0.15, 0.3}},
      {{9.0, 2.5, 3.2}, {3.0, 0.2, 0.5}},
      {{1.75, 0.65, 1.7}, {0.15, 0.12, 0.12}},
      {{0.7, 0.65, 1.75}, {0.2, 0.12, 0.12}},
      {},
  }};
  double measured_sigma_m = 0.1;    ///< Error of an extent that was seen from end to end.
  double hidden_probability = 0.2;  ///< Probability that something covers a part of a visible side.
  /// Sine of the least angle between the view and a side that counts as visible.
  double least_incidence = 0.2;
};

/// A completed box.
struct CompletedBox {
  OrientedBox box;
  Vec3 sigma_m = Vec3::Zero();  ///< The standard deviations of length, width and height.
};

/// Estimates the extent L of an object from the extent m of its points and the prior L ~ N(μ, σ²).
///
/// With the probability `hidden` a part of the object is not seen, and m is only a lower bound:
/// L has the normal distribution truncated to L ≥ m, and m has the density 1/μ up to L.
/// Otherwise m = L + N(0, s²). The result has the mean and standard deviation of the posterior
/// mixture.
Estimate complete_extent(double measured_m, const Estimate& prior, double measured_sigma_m,
                         double hidden);

/// The density of a measured extent under the same model, 1/m.
double extent_density(double measured_m, const Estimate& prior, double measured_sigma_m,
                      double hidden);

/// Whether the sides along the length and along the width are visible, in this order.
std::array<bool, 2> visible_sides(const SegmentShape& shape, double least_incidence);

/// The class of a vehicle whose whole size is known (length, width, height): the one under whose
/// default prior the size is the likeliest. It is `kOther` if an extent is more than 4 standard
/// deviations from that of every class.
ObjectClass vehicle_of(const Vec3& size_m);

/// Completes the box of a segment. The sides that face the viewpoint stay where they are, and the
/// others move away; the bottom stays as well.
CompletedBox complete(const SegmentShape& shape, ObjectClass label,
                      const CompletionOptions& options);

}  // namespace underbrush::perception
