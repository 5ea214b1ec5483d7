/// \file
/// This file has the pairs of rays and elements that a search leaves to be decided.
#pragma once
#include <cstdint>
#include <span>

namespace underbrush::trace {

/// A ray of a query, by its place, and an element that it may meet.
struct Candidate {
  uint32_t ray, instance, element;
};

/// The bounds on a candidate's intersection from single precision, m.
struct ApproachBound {
  float least_t_m;  ///< Not beyond the closest approach; −∞ where nothing is known.
  float reach_m;    ///< τσ of an ellipsoid, which is at least half its chord; 0 of a triangle.
};

/// Candidates with their bounds, in no order.
struct Candidates {
  std::span<const Candidate> pairs;
  std::span<const ApproachBound> bounds;
};

}  // namespace underbrush::trace
