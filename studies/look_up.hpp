/// \file
/// The look-up baseline: a beam is answered with what the training beams near it measured, without
/// any model.
#pragma once
#include "underbrush/core/beam_log.hpp"

namespace underbrush::studies {

/// The ways to look a beam up.
enum class LookUp {
  kRaw,      ///< What the training beam nearest in direction measured, both in the sensor's frame.
  kWarped1,  ///< The end points of the nearest training scan, seen from the test beam's scan.
  kWarped2,  ///< The same of the two nearest training scans.
};

/// Answers the beams of `test`. The nearest training scans are those whose sensor stood nearest,
/// and of these the nearest in time. Among the warped end points within half a ring's spacing of
/// the beam the nearest in range counts; where there is none, what the nearest one in direction
/// measured. Misses keep their direction.
BeamLog looked_up(const BeamLog& train, const BeamLog& test, LookUp how);

}  // namespace underbrush::studies
