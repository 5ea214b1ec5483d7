/// \file
/// The baseline *look-up*: a beam is answered with the measurements of training beams near it,
/// without any model.
#pragma once
#include "underbrush/core/beam_log.hpp"

namespace underbrush::metrics {

/// The ways to look a beam up.
enum class LookUp {
  kRaw,      ///< Measurement of the training beam nearest in direction, both in the sensor's frame.
  kWarped1,  ///< The end points of the nearest training scan, seen from the beam's own origin.
  kWarped2,  ///< The end points of the two nearest training scans, seen likewise.
};

/// Answers the beams of `test`. The nearest training scans are those whose sensor stood nearest,
/// and of these the nearest in time.
///
/// Warped, each end point of these scans is projected again with the beam's own origin, and the one
/// nearest in angle answers with its distance from that origin; where several lie within half a
/// beam (half of the smaller of the angles between neighbouring rings and between neighbouring
/// beams of a ring), the nearest of them in range answers. A training beam that missed has no end
/// point: it keeps its direction, and where it is the nearest in angle, and no end point lies
/// within half a beam, the answer is a miss. Intensities are those of the training beams.
BeamLog looked_up(const BeamLog& train, const BeamLog& test, LookUp kind);

}  // namespace underbrush::metrics
