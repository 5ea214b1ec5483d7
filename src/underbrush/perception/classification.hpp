/// \file
/// This file estimates the class of an object from its size, speed, number of points and range
/// ([rosenberger20] §5).
#pragma once
#include <array>

#include "underbrush/perception/size_prior.hpp"

namespace underbrush::perception {

/// The options of `Classification`.
struct ClassificationOptions {
  /// Prior of each class; unknown has none. The sum need not be 1.
  std::array<double, kClassCount> prior{0, 0.25, 0.05, 0.03, 0.05, 0.07, 0.55};
  /// m/s; the speed of a class is half-normal with this scale.
  std::array<double, kClassCount> speed_m_s{0, 12, 12, 10, 5, 1.3, 0.4};
  /// m; anything else that stands has extents of an exponential distribution with these means.
  Vec3 other_extent_m{3, 1.5, 1.5};
  /// A segment of n points counts with the weight n / (n + n₀), because few points show little.
  double half_points = 20;
  /// Share of the evidence that stays from one cycle to the next.
  double memory = 0.9;
  double least_probability = 0.5;  ///< A class below it is reported as unknown.

  /// Throws `std::invalid_argument` where a value is out of range.
  void check() const;
};

/// The evidence on an object's class: the log-likelihood of each class, up to a constant.
struct ClassEvidence {
  std::array<double, kClassCount> log_likelihood{};
};

/// A naive Bayes classifier. The extents have the densities of `extent_density`, in which a side
/// that is not seen is a lower bound only; the range counts through the number of points.
class Classification {
 public:
  /// Throws `std::invalid_argument` for options out of range. `sizes` are the priors of the sizes.
  Classification(const ClassificationOptions& options, const CompletionOptions& sizes);

  /// Adds the evidence of a cycle.
  void observe(const SegmentShape& shape, double speed_m_s, ClassEvidence& evidence) const;
  /// The probabilities of the classes; their sum is 1.
  std::array<float, kClassCount> probabilities(const ClassEvidence& evidence) const;
  /// The most probable class, or unknown.
  ObjectClass decide(const std::array<float, kClassCount>& probabilities) const;

 private:
  double log_density(ObjectClass label, const SegmentShape& shape, double speed_m_s) const;

  ClassificationOptions options_;
  CompletionOptions sizes_;
};

}  // namespace underbrush::perception
